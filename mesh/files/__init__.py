"""Mesh files by the conventions of MPAS: the only place with indices that start at 1."""
