"""Shortest solutions, acceptance checks and the lock file."""
