"""What a run is made from: scenario files and parameters, and the texts, units and errors of files and console."""
