"""Agents that others wrote: loading them and checking that they keep the contract."""
