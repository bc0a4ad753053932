"""Following a planned path: tracking law, steering while rolling and at standstill, speed profile."""
