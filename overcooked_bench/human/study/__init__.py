"""Studies with people: who plays with which partner in which order, and what they say about it."""
