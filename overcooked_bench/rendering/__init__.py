"""Pictures of kitchens: RGB, text, GIF and replay."""
