"""All that a mesh may be asked to be, from Python; the command line takes the same way."""

import inspect
from dataclasses import fields, replace
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, VoronoiMesh, mesh_quality, scvt_mesh
from mesh.density.gridded import Shaping, read_density
from mesh.density.named import NAMED
from mesh.generation.checkpoint import CheckpointKeeper, described
from mesh.generation.optimizer import Iterate
from mesh.generation.pipeline import generate_mesh
from mesh.geometry.sphere import fibonacci_points
from mesh.mesh_request import MeshRequest


@pytest.fixture(scope="module")
def coarse() -> VoronoiMesh:
    return scvt_mesh(162)


@pytest.fixture
def widths(tmp_path: Path) -> Path:
    """A file of cell widths on a grid: narrow cells in the north, and a value that is far too small."""
    path = tmp_path / "widths.nc"
    with netCDF4.Dataset(path, "w") as file:
        for name, values in (("lat", np.linspace(-90.0, 90.0, 19)), ("lon", np.linspace(0.0, 340.0, 18))):
            file.createDimension(name, len(values))
            file.createVariable(name, "f8", (name,))[:] = values
            file[name].units = "degrees"
        field = file.createVariable("width", "f8", ("lat", "lon"))
        field[:] = 1.5 - 0.5 * np.sin(np.radians(np.linspace(-90.0, 90.0, 19)))[:, None]
        field[3, 4] = 1e-3
    return path


def test_scvt_mesh_takes_all_that_a_request_has_with_the_same_defaults() -> None:
    parameters = inspect.signature(scvt_mesh).parameters
    of_planes = {"plane", "periodic", "hexagons"}  # which `mesh_on_plane` makes
    assert not of_planes & set(parameters)
    for field in fields(MeshRequest):
        if field.name in of_planes:
            continue
        assert parameters[field.name].default == field.default
    assert list(parameters)[:8] == [
        *("cells", "density", "start", "method", "tolerance", "max_iterations", "seed", "callback"),
    ]


def test_a_nested_mesh_keeps_what_the_density_leaves(coarse: VoronoiMesh) -> None:
    mesh = scvt_mesh(density="refined-circle", tolerance=1e-3, nested=coarse)
    assert mesh.n_cells > coarse.n_cells
    assert mesh.fixed_cells is not None
    kept = mesh.cell_points[mesh.fixed_cells]
    assert len(kept) > 50
    assert np.abs(kept @ coarse.cell_points.T).max(axis=1) == pytest.approx(1.0, abs=1e-14)
    with pytest.raises(MeshError, match="cannot refine a mesh of 162"):
        scvt_mesh(100, "refined-circle", nested=coarse)


def test_well_centred() -> None:
    request = MeshRequest(300, "refined-circle", "random-root", tolerance=1e-3)
    plain = generate_mesh(request)
    assert plain.centring is None
    assert mesh_quality(plain.mesh).obtuse > 0
    better = generate_mesh(replace(request, well_centered=True))
    assert mesh_quality(better.mesh).obtuse == 0
    assert better.centring is not None
    assert better.centring.residual > better.centring.residual_before
    again = scvt_mesh(300, "refined-circle", "random-root", tolerance=1e-3, well_centered=True)
    np.testing.assert_array_equal(again.cell_points, better.mesh.cell_points)


def test_time_is_limited() -> None:
    with pytest.raises(MeshError, match="allow more time"):
        scvt_mesh(642, start="random", max_seconds=0.0)


def test_a_field_is_shaped_as_one_that_is_read(widths: Path) -> None:
    density = read_density(widths, "width", Shaping(floor=0.8, power=-4.0, smoothing=1))
    expected = scvt_mesh(200, density, tolerance=1e-3)
    found = scvt_mesh(
        200,
        widths,
        tolerance=1e-3,
        density_variable="width",
        density_floor=0.8,
        density_power=-4.0,
        density_smoothing=1,
    )
    np.testing.assert_array_equal(found.cell_points, expected.cell_points)
    assert found.density_source == expected.density_source
    of_file = MeshRequest(200, widths, density_variable="width", density_floor=0.8, density_power=-4.0)
    of_function = MeshRequest(200, read_density(widths, "width", Shaping(0.8, -4.0)))
    assert described(of_file) == described(of_function)
    assert described(of_file)["density"] == str(widths)
    with pytest.raises(MeshError, match="a density that is a function cannot be shaped"):
        scvt_mesh(200, NAMED["refined-circle"], density_power=2.0)


class InterruptionError(Exception):
    pass


def interrupt(iterate: Iterate) -> None:
    if iterate.number == 7:
        raise InterruptionError


def test_an_interrupted_mesh_goes_on_from_its_checkpoint(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.npz"
    with pytest.raises(InterruptionError):
        scvt_mesh(200, start="random", tolerance=1e-4, checkpoint=path, callback=interrupt)
    with pytest.raises(MeshError, match="made with seed = 0, not 1"):
        scvt_mesh(200, start="random", tolerance=1e-4, seed=1, checkpoint=path, resume=True)
    assert path.exists()
    seen: list[Iterate] = []
    mesh = scvt_mesh(200, start="random", tolerance=1e-4, checkpoint=path, resume=True, callback=seen.append)
    assert mesh.n_cells == 200
    assert not path.exists()
    first: list[Iterate] = []
    scvt_mesh(200, start="random", tolerance=1e-4, callback=first.append)
    assert seen[0].residual < 0.5 * first[0].residual
    with pytest.raises(MeshError, match="name its file with checkpoint"):
        scvt_mesh(200, resume=True)


def test_a_nested_mesh_keeps_no_checkpoint(coarse: VoronoiMesh, tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.npz"
    with pytest.raises(InterruptionError):
        scvt_mesh(density="refined-circle", nested=coarse, checkpoint=path, callback=interrupt)
    assert not path.exists()


def test_a_mesh_has_one_start(coarse: VoronoiMesh, tmp_path: Path) -> None:
    for options in ({"start": "random"}, {"method": "lloyd"}):
        with pytest.raises(MeshError, match="--nested, which starts from that mesh"):
            scvt_mesh(density="refined-circle", nested=coarse, **options)  # type: ignore[arg-type]
    keeper = CheckpointKeeper(tmp_path / "c.npz", MeshRequest(50))
    keeper(Iterate(0, 1.0, 1.0, fibonacci_points(50)))
    keeper.save()
    with pytest.raises(MeshError, match="--nested, which starts from that mesh"):
        generate_mesh(MeshRequest(density="refined-circle", nested=coarse), keeper=keeper, resume=True)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, "the number of cells is None; it must be a number"),
        ({"nested": "coarse.nc"}, "the mesh to refine is 'coarse.nc'; it must be a VoronoiMesh"),
        ({"cells": 42, "max_seconds": "long"}, "the time allowed is 'long'; it must be a number"),
        (
            {"cells": 42, "density_smoothing": 0.5},
            "the number of passes of smoothing is 0.5; it must be a whole number",
        ),
    ],
)
def test_what_makes_no_request_is_refused(options: dict[str, object], words: str) -> None:
    with pytest.raises(MeshError, match=f"^{words}"):
        scvt_mesh(**options)  # type: ignore[arg-type]
