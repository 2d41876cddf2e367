"""What `trisk partition` prints: how evenly a mesh was divided, and how much blocks have to do with each other."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from mesh import Partition
from mesh.partition.measures import PartitionMeasures

MOST_LISTED = 10
"""Blocks that a row names."""


def print_partition(name: str, partition: Partition, measures: PartitionMeasures, paths: Iterable[Path]) -> None:
    """Print the measures of a partition as a table, then what was mended, then the files that were written."""
    fewest, mean, most = measures.cells
    table = Table(title=f"{escape(name)} in {partition.n_blocks} blocks", show_header=False)
    table.add_row("cells", str(len(partition.block_of_cell)))
    table.add_row("cells of a block: fewest, mean, most", f"{fewest}, {mean:.2f}, {most}")
    table.add_row("largest block / mean", f"{measures.balance:.4f}")
    table.add_row("edges between blocks (edge cut)", str(measures.edge_cut))
    table.add_row("neighbouring blocks: mean, most", _mean_and_most(measures.neighbours))
    for rings, sizes in enumerate(measures.halos, 1):
        table.add_row(f"cells within {rings} of a block (halo): mean, most", _mean_and_most(sizes))
    table.add_row("blocks in pieces or empty", str(len(measures.broken)))
    console = Console()
    console.print(table)
    if partition.mended_blocks:
        console.print(f"METIS left {_listed(partition.mended_blocks)} in pieces or empty; mended", soft_wrap=True)
    if measures.broken:
        lies = "lies" if len(measures.broken) == 1 else "lie"
        console.print(f"{_listed(measures.broken)} {lies} on several islands of the mesh", soft_wrap=True)
    for path in paths:
        console.print(escape(str(path)), soft_wrap=True)


def _mean_and_most(values: tuple[float, int]) -> str:
    return f"{values[0]:.2f}, {values[1]}"


def _listed(blocks: Sequence[int]) -> str:
    more = f" and {len(blocks) - MOST_LISTED} more" if len(blocks) > MOST_LISTED else ""
    return f"{'block' if len(blocks) == 1 else 'blocks'} {', '.join(map(str, blocks[:MOST_LISTED]))}{more}"
