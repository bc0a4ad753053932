"""Everything with I/O: scenarios, FMU host, master, observers, manipulators, log, figure, command line."""
