"""Parts of a mesh, which are meshes in which neighbours are missing."""
