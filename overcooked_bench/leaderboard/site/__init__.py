"""The public page of the leaderboard: reads a folder of entries, and writes static files that need nothing else."""
