"""The log of a run: written, read back, recovered."""
