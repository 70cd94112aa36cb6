"""Training runs: where they are written, how they stop and resume, their results."""
