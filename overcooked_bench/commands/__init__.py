"""Groups of commands of `overcooked-bench`, one module each; `cli.py` puts them together."""
