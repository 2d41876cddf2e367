"""Meshes that follow their own solution: run, look where the energy is, make a mesh for it, carry the state over."""
