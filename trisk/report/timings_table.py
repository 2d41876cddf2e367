"""What `trisk bench` prints."""

from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from swe.integrators import Integrator
from swe.run.benchmark import Timing

TITLES: dict[Integrator, str] = {"rk4": "classical RK4", "fbrk3": "FB-RK(3,2)"}


def print_timings(results: Sequence[Timing], case: str) -> None:
    """Print a table of timings on `case`, all of the same integrator, scheme and terms."""
    terms = f", with {' and '.join(results[0].terms)}" if results[0].terms else ""
    scheme = "" if results[0].scheme == "ringler2010" else f", the {results[0].scheme} scheme"
    what = f"{case}, {TITLES[results[0].integrator]}{scheme}{terms}"
    table = Table(
        title=f"{what}: cost per cell and step, medians of alternating turns",
        caption="ns: fused; plain: plain loops; bytes: every array once for each stage; GB/s: bytes by ns; "
        "triad: GB/s of STREAM; budget: bytes that the triad would move in that time",
    )
    for heading in ("cells", "threads", "ns", "plain", "ratio", "bytes", "GB/s", "triad", "budget"):
        table.add_column(heading, justify="right", no_wrap=True)
    for timing in results:
        table.add_row(
            str(timing.cells),
            str(timing.threads),
            f"{timing.ns_per_cell_step:.1f}",
            f"{timing.plain_ns_per_cell_step:.0f}",
            f"{timing.plain_twin_ratio:.2f}",
            f"{timing.bytes_per_cell_step:.0f}",
            f"{timing.gb_per_s:.1f}",
            f"{timing.triad_gb_per_s:.1f}",
            f"{timing.ns_per_cell_step * timing.triad_gb_per_s:.0f}",
        )
    Console().print(table)
