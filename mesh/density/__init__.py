"""Densities of generators: named ones, fields on grids and scattered points, and what a file says of its own."""
