"""What a chef can be shown: one file for each observation, found by `registry`."""
