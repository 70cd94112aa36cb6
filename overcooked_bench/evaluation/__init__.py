"""From games to scores: protocols, blocks of episodes, their store, the statistics and what is shown of them."""
