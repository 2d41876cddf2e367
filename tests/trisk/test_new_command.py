"""A command added as `docs/extending.md` says."""

from pathlib import Path
from typing import Annotated

import pytest
import typer
from typer.testing import CliRunner

import trisk.main
from mesh import VoronoiMesh, write_mesh
from tests.trisk.conftest import Call
from trisk.cli.options import Quiet
from trisk.main import COMMANDS, app_of

PAGE = Path(__file__).parents[2] / "docs" / "extending.md"


def count(
    file: Annotated[Path, typer.Argument(help="MPAS mesh file.")],
    times: Annotated[int, typer.Option("--times", help="Count so often.")] = 1,
    quiet: Quiet = False,
) -> None:
    """Count the cells of a mesh file."""
    from mesh import read_mesh

    mesh = read_mesh(file)
    if not quiet:
        for _ in range(times):
            typer.echo(f"{mesh.n_cells} cells")


@pytest.fixture
def mesh_file(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    return tmp_path / "mesh.nc"


def test_a_new_command_runs_beside_the_others(mesh_file: Path) -> None:
    app = app_of([*COMMANDS, count])
    done = CliRunner().invoke(app, ["count", str(mesh_file), "--times", "2"])
    assert (done.exit_code, done.stdout) == (0, "642 cells\n642 cells\n")
    assert CliRunner().invoke(app, ["count", str(mesh_file), "-q"]).stdout == ""
    told = CliRunner().invoke(app, ["--help"]).stdout
    assert "Count the cells of a mesh file." in told
    assert told.index("  bench ") < told.index("  count ") < told.index("  study ")


def test_its_errors_are_a_line_and_an_exit_code(trisk: Call, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("trisk.main.app", app_of([*COMMANDS, count]))
    code, out, err = trisk("count", tmp_path / "none.nc")
    assert (code, out) == (2, "")
    assert err == f"error: {tmp_path / 'none.nc'}: no such file; give an MPAS mesh file\n"


def test_commands_are_where_the_page_says() -> None:
    page = " ".join(PAGE.read_text().split())
    places = ("`trisk/cli/NAME.py`", "`trisk/mesh_cli`", "`trisk/results_cli`", "`trisk.cli.options`", "`trisk/report`")
    for words in (*places, "`COMMANDS` of `trisk.main`"):
        assert words in page
    for command in COMMANDS:
        assert command.__module__ in (f"trisk.{room}.{command.__name__}" for room in ("cli", "mesh_cli", "results_cli"))
        assert command.__doc__
    folders = [Path(trisk.main.__file__).with_name(room) for room in ("cli", "mesh_cli", "results_cli")]
    modules = {path.stem for folder in folders for path in folder.glob("*.py")}
    assert modules == {"__init__", "options", "study", *(command.__name__ for command in COMMANDS)}
