"""`python -m overcooked_bench` is `overcooked-bench`."""

import sys

from overcooked_bench.cli import main

if __name__ == "__main__":
    sys.exit(main())
