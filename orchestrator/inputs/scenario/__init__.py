"""What is driven: a scenario, read from YAML and from settings."""
