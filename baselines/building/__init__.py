"""Pools built from a configuration: what is trained, the queue that trains it, and how it enters the pool."""
