"""What a scenario says of its slaves and of what feeds what, in its own words or in those of an .ssp."""
