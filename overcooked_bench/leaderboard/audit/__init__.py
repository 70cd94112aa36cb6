"""Audits of results: what was checked, what was found, and what standing follows."""
