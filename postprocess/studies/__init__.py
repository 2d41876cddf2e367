"""Studies over meshes and time steps, with their figures."""
