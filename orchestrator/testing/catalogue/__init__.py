"""Requirements of standards as data, and which of them a controller meets."""
