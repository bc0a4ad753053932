"""A collision-free path among polygons: hybrid A* with Reeds-Shepp expansion and shortcut smoothing, step by step."""
