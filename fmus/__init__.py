"""How a model package becomes an FMU, and what goes with it."""
