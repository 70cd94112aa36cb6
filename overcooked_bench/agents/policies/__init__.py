"""Frozen networks: their files, their architectures, and the agents that play them."""
