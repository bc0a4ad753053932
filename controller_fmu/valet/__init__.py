"""A valet: drives to a goal pose among the polygons of a map, on paths of the planner."""
