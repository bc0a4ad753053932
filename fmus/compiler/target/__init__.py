"""What the C is made of: values and where they lie, variables, functions, entries, the file."""
