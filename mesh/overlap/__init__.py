"""Where the cells of two meshes overlap, and fields carried from one to the other without loss."""
