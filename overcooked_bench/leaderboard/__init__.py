"""The leaderboard: what others submit, checked before it is played."""
