"""A search of a study's ranges for what breaks a requirement, and what its runs prove where nothing does."""
