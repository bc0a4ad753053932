"""Vocabulary of code, pages and commits: private words, one-word constants, participles as names, unclear subjects."""
