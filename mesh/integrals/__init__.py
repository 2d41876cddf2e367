"""Integrals over Voronoi cells: masses, moments and means."""
