"""Ways of the car: which moves lead into a slot, and along which pieces."""
