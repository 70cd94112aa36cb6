"""Submissions as files: `submission.yaml`, `agent.py` and weights in a folder, or packed into one archive."""
