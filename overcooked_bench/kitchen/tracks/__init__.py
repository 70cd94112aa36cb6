"""What two chefs did in a game, as arrays and counts."""
