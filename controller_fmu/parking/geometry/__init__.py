"""Frames, arcs and the vehicle's outline in the plane: what every other package of the parking system measures with."""
