"""Sums that do not depend on how they are divided."""
