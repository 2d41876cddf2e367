"""The options of `trisk mesh` and the description of a mesh are the same."""

import inspect
import re
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

from typer.main import get_command
from typer.testing import CliRunner

from mesh.errors import MeshError
from mesh.generation.scvt import default_tolerance
from mesh.mesh_request import MeshRequest
from trisk.main import app
from trisk.mesh_cli.mesh import mesh


def test_every_field_is_an_option_with_its_default() -> None:
    parameters = inspect.signature(mesh).parameters
    for field in fields(MeshRequest):
        assert parameters[field.name].default == field.default


def test_the_tolerances_that_the_help_tells_are_those_that_are_used() -> None:
    options = get_command(app).commands["mesh"].params  # type: ignore[attr-defined]
    words = next(option.help for option in options if option.name == "tolerance")
    told = [float(number) for number in re.findall(r"\d[\d.e-]*\d|\d", words.replace("1e-8", "1e-08"))]
    assert told == [
        default_tolerance(density, method)
        for method in ("lbfgs", "probabilistic", "macqueen")
        for density in ("uniform", "refined-circle")
    ]


def test_help_loads_no_numbers() -> None:
    program = (
        "import sys, trisk.main, typer.testing\n"
        "done = typer.testing.CliRunner().invoke(trisk.main.app, ['mesh', '--help'])\n"
        "assert '[default: 10000;' in ' '.join(done.stdout.split()), done.stdout\n"
        "assert not {'numpy', 'numba', 'mesh', 'swe', 'cases', 'postprocess'} & set(sys.modules)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


def test_a_mesh_too_large_for_the_format_is_refused_before_it_is_made(tmp_path: Path) -> None:
    words = ["mesh", "--cells", "41943042", "--format", "classic", "-o", str(tmp_path / "mesh.nc")]
    done = CliRunner().invoke(app, words)
    assert isinstance(done.exception, MeshError)
    assert "choose the format cdf5 or netcdf4" in str(done.exception)
