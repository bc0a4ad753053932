"""Mistakes put into the controller's equations on purpose, and whether the tests find them."""
