"""Many scenarios as a test, with JUnit."""
