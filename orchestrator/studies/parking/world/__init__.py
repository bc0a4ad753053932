"""The parking assist in the world outside its own lot: a study with everything disturbed at once."""
