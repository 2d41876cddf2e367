"""Make `shown.json` anew, all that users are shown: PYTHONPATH=docs/tools python tests/regression/make_shown.py.

Figures are described by `described.described`, tables and pages are text. They are made of small meshes and short runs,
so that nothing but what is computed and drawn can change them. What they ought to be is tested elsewhere
(`tests/*/test_*_values.py`); here nothing changes unseen.
"""

import contextlib
import io
import json
import re
import sys
import tempfile
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from described import described
from matplotlib.figure import Figure
from rich.console import Console
from scipy.spatial.transform import Rotation

import mesh_report
from cases import CASES, Galewsky, Williamson2, Williamson5, find_case
from mesh import VoronoiMesh, mesh_from_points, mesh_quality, scvt_mesh
from mesh.arrays import Array
from mesh.generation.optimizer import History
from mesh.geometry.sphere import fibonacci_points
from postprocess.compare.comparison import compare_runs, comparison_record
from postprocess.figures.compare_maps import write_maps
from postprocess.figures.plots import plot_run
from postprocess.figures.spectra_figure import write_spectra_of
from postprocess.reports import compare_report, study_report
from postprocess.runs.reading import read_run
from postprocess.studies import page as pages
from postprocess.studies.families import FAMILIES, Family
from postprocess.studies.mesh_study import Plan
from postprocess.studies.mesh_study import carry_out as carry_out_meshes
from postprocess.studies.table1 import Row
from postprocess.studies.table1_page import table1_lines
from postprocess.studies.time_study import TimePlan
from postprocess.studies.time_study import carry_out as carry_out_times
from swe import Simulation
from swe.run.benchmark import Timing
from trisk.report import case_table, comparison_table, summaries, timings_table

SHOWN_FILE = Path(__file__).with_name("shown.json")
WIDTH = 160
"""Of the terminal that tables are printed to."""

DIGITS = 7


class Shown:
    """Collects what is shown, by names."""

    def __init__(self) -> None:
        self.found: dict[str, Any] = {}

    @contextlib.contextmanager
    def figures(self, start: str) -> Iterator[None]:
        """Take figures in place of saving them."""

        def take(figure: Figure, target: object, **_: object) -> None:
            figure.draw_without_rendering()
            name = Path(target).stem if isinstance(target, str | Path) else f"figure {len(self.found)}"
            self.found[f"{start}: {name}"] = described(figure)

        with mock.patch.object(Figure, "savefig", take):
            yield

    def figure(self, name: str, figure: Figure) -> None:
        """Take one figure."""
        figure.draw_without_rendering()
        self.found[name] = described(figure)

    @contextlib.contextmanager
    def printed(self, name: str) -> Iterator[None]:
        """Take what is printed, without what differs from call to call."""
        text = io.StringIO()
        with (
            mock.patch.dict("os.environ", {"COLUMNS": str(WIDTH), "NO_COLOR": "1", "TERM": "dumb"}),
            contextlib.redirect_stdout(text),
        ):
            yield
        lines = [line.rstrip() for line in text.getvalue().splitlines()]
        self.found[name] = [re.sub(r"(wall-clock time +[│|] )[\d.]+ s +", r"\1", line) for line in lines]


TURNED = Rotation.from_rotvec([0.5, -0.3, 0.2]).as_matrix()
SHIFT = np.array([0.02, -0.015, 0.01])
"""Out of all symmetries, as between cells or pixels that are equal but for round-off each processor chooses its own."""


def _turned(points: Array) -> VoronoiMesh:
    return mesh_from_points(points @ TURNED.T + SHIFT)


def _turned_family(name: str) -> Family:
    family = FAMILIES[name]
    return replace(family, make=lambda cells: _turned(family.make(cells).cell_points))


def shown(folder: Path) -> dict[str, Any]:
    """Everything, made in `folder`."""
    found = Shown()
    with contextlib.chdir(folder), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        _runs(found)
        _studies(found)
        _mesh_page(found)
        _tables(found)
    return json.loads(json.dumps(found.found))


def _runs(found: Shown) -> None:
    for name, points in (("icosahedral", scvt_mesh(162).cell_points), ("spiral", fibonacci_points(120))):
        mesh = _turned(points)
        Simulation(mesh, Williamson5(), name, time_step=3600.0, dissipation=1e15).run(1.0, progress=False)
    runs = [read_run("icosahedral"), read_run("spiral")]
    with found.figures("run"):
        plot_run(runs[0], "figures")
    comparison = compare_runs(*runs, reference="icosahedral")
    with found.figures("maps"):
        write_maps(comparison, "maps")
    found.found["comparison as a record"] = comparison_record(comparison)
    with found.printed("comparison"):
        comparison_table.print_comparison(comparison)
    page = compare_report.ComparisonReport(comparison).write([], Path("."), ["trisk", "compare"])
    found.found["comparison: page"] = _page(page)
    with found.figures("spectra"):
        write_spectra_of(runs, (), "spectra")
    found.found["spectra as a table"] = Path("spectra/spectra.csv").read_text().splitlines()[:12]
    with found.printed("summary of a run"):
        summaries.print_run(Path("icosahedral"))
    with found.printed("quality of a mesh"):
        summaries.print_quality(runs[1].mesh, "spiral")


def _studies(found: Shown) -> None:
    arguments = ["trisk", "study", "mesh"]
    plan = Plan(Path("meshes"), Williamson2(angle=0.3), 0.25, 0.25, ("scvt", "bisection"), (162, 642))
    told: list[str] = []
    families = {name: _turned_family(name) for name in plan.families}
    with (
        found.figures("study of meshes"),
        mock.patch.object(pages, "_png", _taker(found, "study of meshes")),
        mock.patch.dict(FAMILIES, families),
    ):
        finest, rows = carry_out_meshes(plan, False, told.append)
        page = study_report.write_mesh_report(plan, finest, rows, arguments)
    found.found["study of meshes: page"] = _page(page)
    found.found["study of meshes: table"] = rows
    found.found["study of meshes: told"] = told
    times = TimePlan(Path("times"), Galewsky(), scvt_mesh(162), 0.25, (900.0, 1800.0, 3600.0))
    told = []
    with mock.patch.object(pages, "_png", _taker(found, "study of times")):
        time_rows = carry_out_times(times, False, told.append)
        page = study_report.write_time_report(times, time_rows, arguments)
    found.found["study of times: page"] = _page(page)
    found.found["study of times: table"] = time_rows
    found.found["study of times: told"] = told


def _taker(found: Shown, start: str) -> Any:
    def take(figure: Figure) -> bytes:
        found.figure(f"{start}: {figure.get_suptitle()}", figure)
        return b""

    return take


def _page(path: Path) -> list[str]:
    return path.read_text().splitlines()


def _mesh_page(found: Shown) -> None:
    random = np.random.default_rng(4)
    meshes = {"even": scvt_mesh(42), "uneven": mesh_from_points(random.normal(size=(60, 3)))}
    histories = {
        method: History([2.0 + power, 1.0 + power, 1.0], [0.3 * power, 1e-3, 1e-6], [0.0, 0.5, 1.0 + power])
        for method, power in (("lbfgs", 1.0), ("lloyd", 2.0))
    }
    starts = [
        mesh_report.Start(name, number, mesh, mesh_quality(mesh), histories["lbfgs"])
        for number, (name, mesh) in enumerate(meshes.items())
    ]
    found.figure("mesh page: optimisers", mesh_report.optimizer_figure(histories))
    found.figure("mesh page: starts", mesh_report.distribution_figure(starts, mesh_report.PUBLISHED_CIRCLE, "Starts"))
    found.figure("mesh page: meshes", mesh_report.meshes_figure(meshes))
    found.figure("mesh page: sizes", mesh_report.sizes_figure(meshes))
    found.found["mesh page: starts as text"] = mesh_report.starts_lines(starts)
    rows = [Row(2, starts[0].quality, starts[1].quality, 7, 1.25)]
    found.found["mesh page: table 1"] = table1_lines(rows)


def _tables(found: Shown) -> None:
    with found.printed("cases"):
        case_table.print_cases([find_case(name) for name in CASES])
    for name in CASES:
        with found.printed(f"case {name}"):
            case_table.print_case(find_case(name))
    with found.printed("timings"):
        timings_table.print_timings(
            [Timing(10242, 2, 81.25, 406.5, 5.003, 1564.0, 19.25, 18.75, 0.9876)], "williamson5"
        )


def rounded(value: Any) -> Any:
    """Numbers to some digits, so that the file is small."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, dict):
        return {name: rounded(each) for name, each in value.items()}
    return [rounded(each) for each in value] if isinstance(value, list) else value


def main() -> None:
    """Write the file."""
    with tempfile.TemporaryDirectory() as folder:
        found = shown(Path(folder))
    lines = [f"{json.dumps(name)}: {json.dumps(rounded(value))}" for name, value in found.items()]
    SHOWN_FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n")
    Console().print(f"{SHOWN_FILE}: {len(found)} figures, tables and pages")


if __name__ == "__main__":
    sys.exit(main())
