"""Ordered cross-play, as in the thesis: entrants with self-play agents, and with one another."""
