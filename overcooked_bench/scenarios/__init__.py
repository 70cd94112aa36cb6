"""Cooperation unit tests: short edge cases, each with a verdict that a film of a few steps explains."""
