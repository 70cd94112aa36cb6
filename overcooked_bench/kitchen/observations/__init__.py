"""The observations of a chef: one file for each, found by `registry`."""
