"""Identification: parameters of the vehicle and its odometry from a log of a drive, by least squares."""
