"""Playing: blocks of episodes, who sits where, and the store that keeps them."""
