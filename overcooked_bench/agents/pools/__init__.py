"""Pools of frozen agents: manifest, records and lineage."""
