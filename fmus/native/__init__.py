"""The kind of FMU that is machine code: the FMI side in C, platforms, linking."""
