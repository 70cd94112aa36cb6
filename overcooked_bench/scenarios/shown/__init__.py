"""Scenario results as text and tables."""
