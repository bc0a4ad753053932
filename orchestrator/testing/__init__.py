"""Tests of many scenarios: suite, step tests, coverage, catalogue of standards."""
