"""A slot that was found, as it turns out on the way in."""
