"""What the table of a study says: statistics, success maps, the result page."""
