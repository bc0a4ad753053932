"""Each construct of the language, and how it is written in C."""
