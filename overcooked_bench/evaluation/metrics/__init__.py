"""Metrics, one per file; each defines `METRIC`, and nothing else has to know it."""
