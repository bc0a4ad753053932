"""Do two runs agree: signal by signal, within tolerances of value and time."""
