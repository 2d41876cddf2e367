"""Films of a field: its map is drawn once, and each frame looks up the colour of every pixel."""
