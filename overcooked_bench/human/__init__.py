"""Recorded games: people's and agents' games in one file format, and who the people are."""
