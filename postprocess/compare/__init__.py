"""Norms of differences between runs, meshes and references."""
