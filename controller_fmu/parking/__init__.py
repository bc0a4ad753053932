"""Parking system: ultrasonic echoes to a map of landmarks, slots in it, a path into one, and a monitor over all."""
