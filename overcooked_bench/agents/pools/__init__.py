"""Pools of frozen partners: manifest, records and lineage."""
