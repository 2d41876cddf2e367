"""The command line: parsing and calling, no numerics."""
