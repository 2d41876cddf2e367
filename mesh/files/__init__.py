"""Mesh files by the conventions of MPAS: the only place that knows indices that start at 1."""
