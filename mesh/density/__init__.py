"""Densities of generators: named ones, fields on grids and scattered points, and the records of them in mesh files."""
