"""Paths for a car among polygons: search over poses, words of arcs and lines, shortening, smoothing."""
