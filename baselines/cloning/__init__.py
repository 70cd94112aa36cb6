"""Behaviour cloning of recorded games, and how much a clone is like the people it was made from."""
