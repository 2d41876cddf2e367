"""What the commands are given: the mesh they run on and the files they are to write."""
