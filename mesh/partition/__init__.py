"""Cells divided into blocks, one or more for each process: METIS on the graph of cells, mended and measured."""
