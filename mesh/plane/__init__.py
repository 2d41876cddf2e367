"""Meshes on planes."""
