"""Environments to train in: thin wrappers around `Kitchens` that contain no game rules."""
