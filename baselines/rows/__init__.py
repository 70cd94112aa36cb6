"""Entries held against each other: their scores under one protocol, which of them the data separate, and the page."""
