"""Compiled loops over tiles of a mesh, and the Runge-Kutta method fused with them."""
