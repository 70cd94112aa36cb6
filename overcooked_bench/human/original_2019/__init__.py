"""Reads the human games of 2019 from what their authors published, and compares every step with a replay."""
