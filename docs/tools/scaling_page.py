"""Tables and figure of docs/scaling.md: python docs/tools/scaling_page.py FOLDER.

The folder keeps meshes and counts, so that a second call is quick. What two processes measure is printed beside what
the model takes for it; it is worth something on a quiet machine alone.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from postprocess.runs.folders import prepared_folder
from postprocess.studies.table1_page import save
from scaling_counts import DIVISIONS, Counted
from scaling_tables import (
    AS_BUILT,
    CELLS,
    MENDED,
    METIS,
    METIS_OWN_FIRST,
    PARTS,
    RK4,
    WEAK_CELLS,
    Setting,
    cause_lines,
    division_lines,
    resizing_lines,
    setting_lines,
    strong_lines,
    table,
    weak_counts,
    weak_lines,
    weak_parts,
)
from swe.parallel.exchange_counts import ExchangeCounts

EXCHANGE_PROGRAM = Path(__file__).with_name("scaling_exchange.py")
EXCHANGE_CELLS = (642, 2562, 10242, 40962, 163842)

LOOKS: dict[str, tuple[Setting, dict[str, str]]] = {
    "curve, as built": (AS_BUILT, {"marker": "o"}),
    "METIS, as built": (METIS, {"marker": "s", "linestyle": "--"}),
    "METIS, own cells numbered first": (METIS_OWN_FIRST, {"marker": "d", "linestyle": "-."}),
    "curve, no Python within a step": (MENDED, {"marker": "^", "linestyle": ":"}),
}
"""Setting and look of each line by its label."""


def measured_exchanges(folder: Path, cells: tuple[int, ...] = EXCHANGE_CELLS) -> list[dict[str, Any]]:
    """What `scaling_exchange` finds on two processes of one thread each."""
    results = folder / "exchanges.json"
    mpiexec = shutil.which("mpiexec", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
    if mpiexec is None:
        raise SystemExit("mpiexec is not installed; pip install 'trisk[mpi]' brings it")
    program = [mpiexec, "-n", "2", sys.executable, "-m", "mpi4py", str(EXCHANGE_PROGRAM), str(results)]
    subprocess.run([*program, *map(str, cells)], check=True, env={**os.environ, "NUMBA_NUM_THREADS": "1"})
    found: list[dict[str, Any]] = json.loads(results.read_text())
    return found


def exchange_lines(found: list[dict[str, Any]]) -> list[str]:
    """The table of measured exchanges, microseconds: a tenth of the turns is quicker than the first of two numbers.

    What a pass adds is the difference of the first numbers of steps with exchanges and without.
    """
    names = ("cells", "part_cells", "messages", "bytes_sent")
    rows = [
        [
            *(str(each[name]) for name in names),
            *(", ".join(f"{1e6 * value:.0f}" for value in each[name]) for name in ("exchange", "step", "alone")),
            f"{1e6 * (each['step'][0] - each['alone'][0]) / RK4.passes:.0f}",
        ]
        for each in found
    ]
    heading = [
        "cells",
        "cells of a part",
        "messages",
        "bytes sent",
        "exchange",
        "step",
        "step alone",
        "added by a pass",
    ]
    return table(heading, rows)


def scaling_figure(counted: Counted) -> Figure:
    """Weak efficiency on the left, strong efficiency on the right, against the number of processes."""
    figure = Figure(figsize=(11.0, 4.6), layout="constrained")
    weak, *strong = figure.subplots(1, 1 + len(CELLS))
    _draw(weak, {parts: [weak_counts(counted, parts, d) for d in DIVISIONS] for parts in weak_parts()})
    weak.set_title(f"Weak: {WEAK_CELLS} cells a process", fontsize=10)
    for axes, cells in zip(strong, CELLS, strict=True):
        _draw(axes, {parts: [counted.counts(cells, parts, d) for d in DIVISIONS] for parts in PARTS})
        axes.set_title(f"Strong: {cells} cells", fontsize=10)
        axes.set_ylim(0.0, 1.03)
    weak.set_ylabel("parallel efficiency")
    weak.set_ylim(0.8, 1.006)
    weak.legend(fontsize=8, loc="lower left")
    return figure


def _draw(axes: Axes, counts: dict[int, list[ExchangeCounts]]) -> None:
    for label, (setting, look) in LOOKS.items():
        number = DIVISIONS.index(setting.division)
        efficiency = [setting.time(each[number]).efficiency for each in counts.values()]
        axes.semilogx([*counts], efficiency, label=label, markersize=5, **look)
    axes.axhline(0.9, color="0.5", linewidth=0.8)
    axes.set_xlabel("processes")
    axes.grid(alpha=0.3)


def main() -> None:
    """Write the figure to the folder, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path, help="where scaling.png goes, and what is kept for the next time")
    folder = parser.parse_args().folder
    prepared_folder(folder)
    counted = Counted(folder)
    for lines in (division_lines, weak_lines, setting_lines, strong_lines, cause_lines, resizing_lines):
        print("\n".join([f"{lines.__name__}:", "", *lines(counted), ""]), flush=True)
    print(save(scaling_figure(counted), folder, "scaling"))
    print("\n".join(["", *exchange_lines(measured_exchanges(folder))]))


if __name__ == "__main__":
    main()
