"""The language of scenario files: pictures, conditions and scripts, read and written."""
