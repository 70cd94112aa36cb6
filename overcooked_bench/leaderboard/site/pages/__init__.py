"""The pages of the leaderboard, one kind per file, and the programs in them."""
