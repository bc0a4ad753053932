"""The monitors: collision by the outline swept over the stopping distance, and faults of vehicle and driver."""
