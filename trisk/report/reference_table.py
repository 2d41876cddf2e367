"""What `trisk reference` prints: how the truncations of a spectral reference differ."""

from rich.console import Console
from rich.table import Table

from postprocess.reference.making import MEASURES, Reference


def print_differences(reference: Reference) -> None:
    """Print the norms of the differences from the finest truncation."""
    finest = reference.truncations[-1]
    table = Table(title=f"{reference.case.title}: relative l2 norms of the difference from T{finest}")
    for column in ("truncation", "day", *MEASURES):
        table.add_column(column, justify="right")
    for truncation, by_day in zip(reference.truncations[:-1], reference.differences, strict=True):
        for day, norms in zip(reference.days, by_day, strict=True):
            table.add_row(f"T{truncation}", f"{day:g}", *(f"{norm:.2e}" for norm in norms))
    Console().print(table)
