"""Commands that make, change and measure meshes, one a module."""
