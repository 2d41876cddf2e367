"""Cases by their names."""
