"""The co-simulation algorithm, its FMU instances, faults, stop conditions, and the recording of a run."""
