"""The sections of a score's report, one per file."""
