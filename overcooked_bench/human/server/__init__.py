"""People play with agents, or with each other, in a browser: `overcooked-bench play`."""
