"""The game: rules, layouts, states, starts, observations and events, for thousands of kitchens at once."""
