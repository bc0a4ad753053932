"""Runs and systems for other tools."""
