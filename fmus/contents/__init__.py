"""What every kind of FMU carries: description, units, pages, icon, terminals, reference result, the archive itself."""
