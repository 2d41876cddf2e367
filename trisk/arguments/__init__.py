"""What commands are given: the mesh they run on and the files they write."""
