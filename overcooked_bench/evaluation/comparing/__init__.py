"""Compares scores of the same games: differences with intervals, tests, and what training seeds buy."""
