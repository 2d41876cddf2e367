"""Files of meshes with walls: ours come back to the bit, those of the community's culler are read, damage is told."""

import warnings
from collections.abc import Callable
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from numpy.typing import NDArray

from mesh import MeshError, MeshWarning, VoronoiMesh, mesh_from_points, read_mesh, scvt_mesh, validate_mesh, write_mesh
from mesh.conventions import MESH_VARIABLES
from mesh.discrete.walls import wall_edges
from mesh.files import io
from mesh.files.io import FORMATS
from mesh.parts.culling import culled
from tests.plain_culler import cull_file

EARTH = 6371229.0


def seas_of(mesh: VoronoiMesh) -> NDArray[np.bool_]:
    """Two seas, with an island of one cell in the southern one."""
    kept = np.abs(mesh.lat_cell - 0.4) > 0.25
    kept[np.argmin(mesh.lat_cell)] = False
    return kept


@pytest.fixture
def sea(any_mesh: VoronoiMesh) -> VoronoiMesh:
    return culled(any_mesh, seas_of(any_mesh))


@pytest.fixture
def sea_file(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    """Without the stamp, so that it is validated in full."""
    path = tmp_path / "sea.nc"
    write_mesh(culled(icosahedral_mesh, seas_of(icosahedral_mesh)), path)
    forget_stamp(path)
    return path


def forget_stamp(path: Path) -> None:
    with netCDF4.Dataset(path, "r+") as file:
        if "validated_hash" in file.ncattrs():
            file.delncattr("validated_hash")


def assert_same(found: VoronoiMesh, expected: VoronoiMesh) -> None:
    for variable in MESH_VARIABLES:
        value, wanted = getattr(found, variable.name), getattr(expected, variable.name)
        np.testing.assert_array_equal(value, wanted, err_msg=variable.name, strict=True)
        assert value.tobytes() == wanted.tobytes(), variable.name


def contents(path: Path) -> dict[str, object]:
    """All of a file but its history."""
    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        arrays = {
            name: (values.dimensions, values[:].tobytes(), values.ncattrs()) for name, values in file.variables.items()
        }
        sizes = {name: len(dimension) for name, dimension in file.dimensions.items()}
        return {**arrays, **sizes, **{name: file.getncattr(name) for name in file.ncattrs() if name != "history"}}


@pytest.mark.parametrize("file_format", FORMATS)
@pytest.mark.parametrize("radius", [1.0, EARTH])
def test_a_file_read_and_written_is_the_same(
    sea: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, file_format: str, radius: float
) -> None:
    monkeypatch.setattr(io, "assembled_mesh", None)  # the stamp says that it is valid
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        write_mesh(sea.scaled(radius), tmp_path / "first.nc", file_format=file_format)
        read = read_mesh(tmp_path / "first.nc")
        write_mesh(read, tmp_path / "second.nc", file_format=file_format)
    assert_same(read, sea.scaled(radius))
    first = contents(tmp_path / "first.nc")
    assert first == contents(tmp_path / "second.nc")
    assert "validated_hash" in first


@pytest.mark.parametrize("radius", [1.0, EARTH])
def test_reading_in_full_gives_the_same_without_a_word(sea: VoronoiMesh, tmp_path: Path, radius: float) -> None:
    write_mesh(sea.scaled(radius), tmp_path / "sea.nc")
    forget_stamp(tmp_path / "sea.nc")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_same(read_mesh(tmp_path / "sea.nc"), sea.scaled(radius))
        rebuilt = read_mesh(tmp_path / "sea.nc", recompute_metrics=True)
    residuals = validate_mesh(rebuilt)
    assert max(residuals.values()) < 1e-13
    np.testing.assert_allclose(rebuilt.area_triangle, sea.scaled(radius).area_triangle, rtol=1e-11)
    np.testing.assert_allclose(rebuilt.weights_on_edge, sea.weights_on_edge, rtol=0.0, atol=1e-11)


def test_what_the_communitys_rules_make_is_read(any_mesh: VoronoiMesh, sea: VoronoiMesh, tmp_path: Path) -> None:
    """Angles and weights of edges that were turned, and edges that are gone, are set right; all else stays."""
    write_mesh(any_mesh, tmp_path / "mesh.nc")
    cull_file(tmp_path / "mesh.nc", tmp_path / "sea.nc", seas_of(any_mesh))
    with netCDF4.Dataset(tmp_path / "sea.nc") as file:
        file.set_auto_mask(False)
        assert not np.array_equal(file["weightsOnEdge"][:], sea.weights_on_edge)
        assert (file["nEdgesOnEdge"][:] > sea.n_edges_on_edge).any()
    with pytest.warns(MeshWarning, match=r"sorted edgesOnEdge; replaced angleEdge \(differed by up to 3.1e\+00 rad\)"):
        read = read_mesh(tmp_path / "sea.nc")
    for variable in MESH_VARIABLES:
        found, expected = getattr(read, variable.name), getattr(sea, variable.name)
        if variable.name == "angle_edge":
            np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * expected), rtol=0.0, atol=1e-12)
        else:
            np.testing.assert_array_equal(found, expected, err_msg=variable.name, strict=True)
    validate_mesh(read)


def test_a_single_cell_and_a_sea_of_random_cells_are_read(any_mesh: VoronoiMesh, tmp_path: Path) -> None:
    write_mesh(any_mesh, tmp_path / "mesh.nc")
    for kept in (np.arange(any_mesh.n_cells) == 5, np.random.default_rng(1).random(any_mesh.n_cells) < 0.5):
        cull_file(tmp_path / "mesh.nc", tmp_path / "sea.nc", kept)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", MeshWarning)
            read = read_mesh(tmp_path / "sea.nc")
        np.testing.assert_array_equal(read.weights_on_edge, culled(any_mesh, kept).weights_on_edge)
        validate_mesh(read)


def test_normals_that_enter_through_a_wall_are_turned(sea_file: Path) -> None:
    original = read_mesh(sea_file)
    with netCDF4.Dataset(sea_file, "r+") as file:
        for name in ("cellsOnEdge", "verticesOnEdge"):
            pairs = file[name][:]
            walls = wall_edges(original)[::2]
            pairs[walls] = pairs[walls][:, ::-1]
            file[name][:] = pairs
    with pytest.warns(MeshWarning, match="sorted verticesOnEdge, cellsOnEdge|sorted cellsOnEdge, verticesOnEdge"):
        assert_same(read_mesh(sea_file), original)


def test_noise_of_converters_is_accepted_with_a_warning(sea_file: Path) -> None:
    random = np.random.default_rng(0)
    with netCDF4.Dataset(sea_file, "r+") as file:
        for name in ("areaCell", "kiteAreasOnVertex", "weightsOnEdge"):
            values = file[name][:]
            file[name][:] = values * (1 + 1e-7 * random.uniform(-1, 1, values.shape))
    with pytest.warns(MeshWarning, match=r"holds only to \d\.\de-0[78].*recompute"):
        read_mesh(sea_file)


@pytest.mark.parametrize(
    "missing",
    [
        ("weightsOnEdge",),
        ("edgesOnEdge", "nEdgesOnEdge", "weightsOnEdge"),
        ("boundaryVertex", "latVertex", "lonEdge", "meshDensity"),
        ("cellsOnCell", "edgesOnCell", "verticesOnCell", "nEdgesOnCell", "edgesOnVertex"),
        ("xEdge", "yEdge", "zEdge", "dcEdge", "dvEdge", "angleEdge"),
        ("kiteAreasOnVertex", "areaCell", "areaTriangle"),
    ],
    ids=lambda names: names[0],
)
def test_what_is_missing_is_made(sea_file: Path, tmp_path: Path, missing: tuple[str, ...]) -> None:
    original = read_mesh(sea_file)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MeshWarning)
        read = read_mesh(without(sea_file, tmp_path / "less.nc", missing))
    for variable in MESH_VARIABLES:
        if variable.name != "mesh_density":
            found, expected = getattr(read, variable.name), getattr(original, variable.name)
            np.testing.assert_allclose(found, expected, rtol=1e-11, atol=1e-13, err_msg=variable.name)


@pytest.mark.parametrize(
    ("missing", "sentence"),
    [
        (("xVertex",), "xVertex, yVertex and zVertex are missing; of a mesh with walls they do not follow"),
        (
            ("verticesOnEdge",),
            "verticesOnEdge missing: a mesh with walls must say which cells and vertices an edge has",
        ),
        (
            ("cellsOnEdge",),
            "do not close a sphere: .* only meshes with walls, which cellsOnEdge and cellsOnVertex mark",
        ),
        (("cellsOnVertex",), "the variable cellsOnVertex is missing"),
    ],
)
def test_what_cannot_be_made_is_asked_for(
    sea_file: Path, tmp_path: Path, missing: tuple[str, ...], sentence: str
) -> None:
    names = (*missing, "lonVertex") if "xVertex" in missing else missing
    with pytest.raises(MeshError, match=sentence):
        read_mesh(without(sea_file, tmp_path / "less.nc", names))


def without(source: Path, target: Path, missing: tuple[str, ...]) -> Path:
    with netCDF4.Dataset(source) as old, netCDF4.Dataset(target, "w") as new:
        old.set_auto_mask(False)
        new.setncatts({name: old.getncattr(name) for name in old.ncattrs()})
        for name, dimension in old.dimensions.items():
            new.createDimension(name, len(dimension))
        for name, variable in old.variables.items():
            if name not in missing:
                new.createVariable(name, variable.dtype, variable.dimensions)[:] = variable[:]
    return target


Change = Callable[[NDArray, VoronoiMesh], None]


def at_wall(value: float) -> Change:
    """Another value at a wall."""

    def change(values: NDArray, mesh: VoronoiMesh) -> None:
        values[wall_edges(mesh)[3]] = value

    return change


def at_boundary(factor: float) -> Change:
    """A multiple of the values at a boundary vertex with two cells."""

    def change(values: NDArray, mesh: VoronoiMesh) -> None:
        values[np.flatnonzero((mesh.cells_on_vertex < 0).sum(axis=1) == 1)[3]] *= factor

    return change


def gap_within(values: NDArray, mesh: VoronoiMesh) -> None:
    """A cell is lost at a vertex or an edge away from walls."""
    values[np.flatnonzero(np.all(values > 0, axis=1))[40], 1] = 0


def another_cell(values: NDArray, mesh: VoronoiMesh) -> None:
    """A wall has another cell."""
    values[wall_edges(mesh)[3], 0] += 7


def outside(values: NDArray, mesh: VoronoiMesh) -> None:
    values[wall_edges(mesh)[3], 1] = mesh.n_vertices + 1


def nearer_to_the_centre(values: NDArray, mesh: VoronoiMesh) -> None:
    values[np.flatnonzero(mesh.boundary_vertex)[3]] *= 0.9


@pytest.mark.parametrize(
    ("name", "change", "sentence"),
    [
        ("dcEdge", at_wall(-1.0), "dcEdge is no distance at which the missing cell of a wall may stand"),
        ("dcEdge", at_wall(np.nan), "dcEdge is no distance at which the missing cell of a wall may stand"),
        ("dcEdge", at_wall(3.0), "dcEdge is no distance at which the missing cell of a wall may stand"),
        ("dvEdge", at_wall(0.5), "dvEdge differs from what the generators give"),
        ("kiteAreasOnVertex", at_boundary(1.1), "areaCell differs from what the generators give"),
        ("areaTriangle", at_boundary(1.1), "areaTriangle differs from what the generators give"),
        ("xVertex", nearer_to_the_centre, r"(dvEdge|xVertex, yVertex or zVertex) differs|are not at sphere_radius"),
        ("weightsOnEdge", at_wall(0.7), "weightsOnEdge differs from what the generators give"),
        ("cellsOnEdge", another_cell, "form no ring by their verticesOnEdge"),
        ("cellsOnEdge", gap_within, "cellsOnVertex holds other cells than those of the edges|form no ring"),
        (
            "cellsOnVertex",
            gap_within,
            r"cellsOnVertex holds \[.*\] where cellsOnVertex and cellsOnEdge give|other cells",
        ),
        ("verticesOnEdge", outside, r"verticesOnEdge holds an index outside 1 to \d+"),
    ],
)
def test_damage_is_told_in_one_sentence(sea_file: Path, name: str, change: Change, sentence: str) -> None:
    mesh = read_mesh(sea_file)
    with netCDF4.Dataset(sea_file, "r+") as file:
        values = file[name][:]
        change(values, mesh)
        file[name][:] = values
    with pytest.raises(MeshError, match=sentence) as error:
        read_mesh(sea_file)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("name", "value", "word"),
    [("boundaryVertex", 1, "boundaryVertex"), ("xEdge", 0.3, "xEdge, yEdge"), ("angleEdge", 9.0, "angleEdge")],
)
def test_what_no_step_depends_on_is_set_right(sea_file: Path, name: str, value: float, word: str) -> None:
    original = read_mesh(sea_file)
    with netCDF4.Dataset(sea_file, "r+") as file:
        inner = np.flatnonzero(original.boundary_vertex == 0)[5]
        file[name][inner if name == "boundaryVertex" else wall_edges(original)[3]] = value
    with pytest.warns(MeshWarning, match=f"replaced .*{word}"):
        read = read_mesh(sea_file)
    np.testing.assert_array_equal(read.boundary_vertex, original.boundary_vertex)
    np.testing.assert_allclose(read.x_edge, original.x_edge, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(np.exp(1j * read.angle_edge), np.exp(1j * original.angle_edge), rtol=0.0, atol=1e-12)


def test_a_gap_in_a_mesh_of_the_whole_sphere_is_no_wall(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    path = tmp_path / "mesh.nc"
    for name in ("cellsOnVertex", "cellsOnEdge"):
        write_mesh(icosahedral_mesh, path)
        with netCDF4.Dataset(path, "r+") as file:
            file[name][7, 1] = 0
        with pytest.raises(MeshError, match=f"{name} holds an index outside 1 to 642; only a mesh with walls"):
            read_mesh(path)


def test_a_mesh_that_refines_has_no_walls(icosahedral_mesh: VoronoiMesh) -> None:
    with pytest.raises(MeshError, match="the mesh to refine has walls; give one of the whole sphere"):
        scvt_mesh(nested=culled(icosahedral_mesh, icosahedral_mesh.lat_cell < 0.5), cells=700, density="refined-circle")


def test_an_obtuse_mesh_with_walls_is_read(tmp_path: Path) -> None:
    """Vertices far from the middles of their edges, and kites of negative area, at walls too."""
    mesh = mesh_from_points(np.random.default_rng(8).normal(size=(150, 3)))
    sea = culled(mesh, mesh.lat_cell < 0.3)
    assert sea.kite_areas_on_vertex[sea.boundary_vertex == 1].min() < 0.0
    write_mesh(sea, tmp_path / "sea.nc")
    forget_stamp(tmp_path / "sea.nc")
    assert_same(read_mesh(tmp_path / "sea.nc"), sea)
