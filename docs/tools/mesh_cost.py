"""Seconds and peak memory of `trisk mesh` and `trisk partition`: python docs/tools/mesh_cost.py [CELLS ...].

Prints the rows of the table in docs/performance.md. Each command runs in a process of its own and in turn, so its
start counts too; processor time tells more than seconds where other programs are busy. Compile first, by a small mesh.
"""

import os
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

CELLS = (163842, 655362, 2621442)
BLOCKS = 64
HEADER = "| cells | command | s | processor s | peak GB | bytes per cell |\n|---|---|---|---|---|---|"


@dataclass(frozen=True)
class Cost:
    """What a process took: seconds, seconds of processors (user and system), and bytes at its peak."""

    seconds: float
    processor_seconds: float
    peak: int


def cost_of(command: Sequence[str]) -> Cost:
    """Run a command to its end, with standard output thrown away; raises `RuntimeError` where it fails.

    Linux tells no peak below the memory of the process that calls this.
    """
    begin = time.perf_counter()
    nothing = [(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)]
    process = os.posix_spawn(command[0], command, os.environ, file_actions=nothing)
    _, status, usage = os.wait4(process, 0)
    seconds = time.perf_counter() - begin
    if status != 0:
        raise RuntimeError(f"{' '.join(command)} ended with exit code {os.waitstatus_to_exitcode(status)}")
    unit = 1 if sys.platform == "darwin" else 1024
    return Cost(seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * unit)


def row(cells: int, name: str, cost: Cost) -> str:
    """A row of the table."""
    return (
        f"| {cells} | {name} | {cost.seconds:.1f} | {cost.processor_seconds:.1f} | {cost.peak / 1e9:.2f} | "
        f"{cost.peak / cells:.0f} |"
    )


def main(sizes: Sequence[int]) -> None:
    """Make and divide meshes of these numbers of cells, and print what that costs."""
    print(HEADER)
    trisk = (sys.executable, "-m", "trisk")
    for cells in sizes:
        with tempfile.TemporaryDirectory() as folder:
            mesh, blocks = str(Path(folder) / "mesh.nc"), str(Path(folder) / "blocks")
            made = cost_of([*trisk, "mesh", "--cells", str(cells), "-o", mesh])
            print(row(cells, "mesh", made), flush=True)
            divided = cost_of([*trisk, "partition", mesh, "--blocks", str(BLOCKS), "-o", blocks])
            print(row(cells, "partition", divided), flush=True)


if __name__ == "__main__":
    main([int(cells) for cells in sys.argv[1:]] or CELLS)
