"""Instances as a system: connections, units, frames, roles, and diagnostics before a run."""
