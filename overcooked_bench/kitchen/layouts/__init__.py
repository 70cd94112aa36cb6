"""The shipped floor plans, one `.layout` file each."""
