"""Voronoi cells clipped by a coast: their generators, and the mesh whose wall is the coast itself."""
