"""What is measured of a state: invariants, and the part that each term has in their changes."""
