"""Runs as users hold them in Python and in notebooks."""
