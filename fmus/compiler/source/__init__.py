"""What the model's Python says: its functions and types, where names lead, what is bound where, what is refused."""
