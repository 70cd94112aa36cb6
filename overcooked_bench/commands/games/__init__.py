"""`overcooked-bench games`: one file per command of the group."""
