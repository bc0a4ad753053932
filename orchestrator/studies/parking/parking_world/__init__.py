"""Parking in ordinary streets and car parks: rows of cars, hitches, pillars, bins, what stands across the road."""
