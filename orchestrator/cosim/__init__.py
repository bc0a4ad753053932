"""Slaves stepped together: the master, its slaves, faults, endings, and the recording of a run."""
