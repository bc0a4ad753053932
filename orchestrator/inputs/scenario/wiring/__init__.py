"""What a scenario says of its instances and of what feeds what, in its own words or in those of an .ssp."""
