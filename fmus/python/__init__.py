"""The kind of FMU that runs a model's Python source (PythonFMU)."""
