"""Triangulations of points on the sphere: hull, half-edges, flips, and one that moves with its points."""
