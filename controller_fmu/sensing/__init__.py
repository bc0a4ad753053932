"""What distance sensors tell of the surroundings, whatever way the car is turned: echoes, contour, slots."""
