"""A slot that is looked for, and as it turns out on the way in once it is found."""
