"""Submissions, agents that others wrote: loads them and checks that they keep the contract."""
