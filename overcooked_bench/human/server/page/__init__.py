"""The page of `overcooked-bench play`: its text, its look, and its program."""
