"""Runs as pages for a browser: the globe, a map, the values of every cell."""
