"""Environments to train in: thin shells around the kitchen that hold no rule of the game."""
