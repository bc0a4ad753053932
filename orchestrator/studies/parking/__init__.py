"""Studies of the parking assist."""
