"""Views of runs for people and tools: log, figures, replay page, export."""
