"""The discrete calculus on a mesh: topology, metrics, weights, operators, quality, and their checks."""
