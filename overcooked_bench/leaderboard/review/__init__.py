"""Reviews what a pull request adds to the results."""
