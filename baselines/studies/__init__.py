"""Registered studies: a plan that is committed before anything is trained, its recipe, and the code that decides."""
