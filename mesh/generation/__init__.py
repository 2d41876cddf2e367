"""Generators of SCVTs: starting points, descents, nested and well-centred meshes."""
