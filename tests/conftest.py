"""What holds for all tests."""

import os

# Tiny networks on two threads, in two workers on two cores, wait for each other many times longer than they compute.
os.environ.setdefault("OMP_NUM_THREADS", "1")

pytest_plugins = ["pytester", "tests.browsing"]
