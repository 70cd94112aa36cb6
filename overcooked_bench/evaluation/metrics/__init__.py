"""Metrics, one per file; each defines `METRIC`, and is found without registration elsewhere."""
