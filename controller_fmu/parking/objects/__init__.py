"""Moving objects: tracks of echoes that the map does not explain, with their closing rate."""
