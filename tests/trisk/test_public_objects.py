"""Every object that `import trisk` has the class of shows itself in a few lines, as text and in a notebook."""

import inspect
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import trisk
from mesh import VoronoiMesh
from postprocess.runs.reading import Snapshot
from swe.diagnostics.outputs import FIELDS

MOST_LINES, MOST_CHARACTERS = 13, 900


def nothing(*_: object) -> float:
    return 0.0


MAKERS: dict[str, Callable[[VoronoiMesh], object]] = {
    "MeshRequest": lambda mesh: trisk.MeshRequest(nested=mesh, density=nothing, tolerance=1e-3, seed=1),
    "Operators": trisk.build_operators,
    "Partition": lambda mesh: trisk.Partition(np.arange(mesh.n_cells) % 40, 40, tuple(range(40))),
    "Quality": trisk.mesh_quality,
    "Region": lambda mesh: trisk.find_region("280,350,10,60"),
    "VoronoiMesh": lambda mesh: trisk.cull_mesh(mesh, "0,360,-90,20"),
    "Callback": lambda mesh: trisk.Callback(nothing, 60.0),
    "Forcing": lambda mesh: trisk.Forcing("wind", acceleration=nothing),
    "LinearDrag": lambda mesh: trisk.LinearDrag(1e-5),
    "QuadraticDrag": lambda mesh: trisk.QuadraticDrag(1e-3),
    "ShallowWaterModel": lambda mesh: trisk.Simulation(mesh, trisk.Williamson5()).model,
    "Simulation": lambda mesh: trisk.Simulation(mesh, trisk.Williamson5(), dissipation=1e15, anticipation=0.5),
    "State": lambda mesh: trisk.State(mesh.lat_cell, mesh.lat_edge),
    "ThicknessRelaxation": lambda mesh: trisk.ThicknessRelaxation(nothing, 3600.0),
    "Viscosity": lambda mesh: trisk.Viscosity(1e5),
    "WindStress": lambda mesh: trisk.WindStress(nothing, 0.1),
    "Case": lambda mesh: trisk.find_case("williamson2"),
    "PlaneCase": lambda mesh: trisk.find_case("inertia-gravity-wave"),
}


def classes() -> list[str]:
    """Names of the public classes whose instances are not errors."""
    public = {name: getattr(trisk, name) for name in trisk.__all__}
    return [name for name, it in public.items() if inspect.isclass(it) and not issubclass(it, BaseException)]


def require_few_lines(shown: object) -> None:
    text, table = repr(shown), shown._repr_html_()  # type: ignore[attr-defined]
    assert text.startswith("<")
    assert text.endswith(">")
    assert 2 <= len(text.splitlines()) <= MOST_LINES, text
    assert len(text) <= MOST_CHARACTERS, text
    assert "array(" not in text
    assert "[" not in text
    assert "object at 0x" not in text, text
    assert table.count("<tr>") == len(text.splitlines()) - 1


@pytest.mark.parametrize("name", classes())
def test_objects_show_themselves_in_a_few_lines(name: str, small_mesh: VoronoiMesh) -> None:
    kind = getattr(trisk, name)
    shown = kind() if issubclass(kind, trisk.Case) and name not in ("Case", "PlaneCase") else MAKERS[name](small_mesh)
    assert isinstance(shown, kind)
    require_few_lines(shown)


def test_what_functions_give_shows_itself(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    simulation = trisk.Simulation(small_mesh, trisk.Williamson2(), tmp_path / "run")
    simulation.run(days=0.1, progress=False)
    run = trisk.open_run(tmp_path / "run")
    for shown in (simulation, run, run.last_snapshot(), run.mesh):
        require_few_lines(shown)
    require_few_lines(Snapshot(0.0, {name: np.linspace(1.0, 2.0, 7) for name in FIELDS}))
    for text in (repr(simulation.invariants), repr(trisk.compare_runs(run)), repr(trisk.CASES)):
        assert len(text.splitlines()) <= MOST_LINES


def test_names_are_escaped_in_notebooks(small_mesh: VoronoiMesh, tmp_path: Path) -> None:
    (tmp_path / "<b>.py").write_text("from cases import Williamson2\nclass Mine(Williamson2):\n    title = '<i>'\n")
    case = trisk.find_case(f"{tmp_path / '<b>.py'}:Mine")
    simulation = trisk.Simulation(small_mesh, case, tmp_path / "<b>")
    simulation.run(days=0.1, progress=False)
    region = trisk.Region("<b>", lambda points: points[:, 0])
    for shown in (case, simulation, trisk.open_run(tmp_path / "<b>"), region):
        assert "<b>" in repr(shown)
        table = shown._repr_html_()
        assert "&lt;b&gt;" in table
        assert "<b>" not in table
        assert "<i>" not in table
