"""Training runs: where they are written, how they stop and resume, what comes of them."""
