"""The shipped cooperation unit tests, one edge case a file; `overcooked_bench.scenarios` reads and judges them."""
