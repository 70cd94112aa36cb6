"""What is measured about a whole pool: cross-play, profiles, verification."""
