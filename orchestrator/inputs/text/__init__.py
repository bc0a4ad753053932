"""Text that comes in: quantities with units, YAML, name patterns, and the error a user sees."""
