"""Dissipation in loops over tiles."""
