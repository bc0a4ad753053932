"""Studies: thousands of runs of one scenario with parameters varied, in one table."""
