"""What is measured of a state: invariants, and how much each term changes them."""
