"""The co-simulation: algorithm, FMU instances, imported FMUs, and the system that connects them."""
