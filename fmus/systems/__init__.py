"""Several FMUs as one thing: the .ssp and the FMU container."""
