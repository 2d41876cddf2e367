import shutil
import warnings
from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import MeshError, MeshWarning, VoronoiMesh, read_mesh, write_mesh
from mesh.conventions import BY_NAME, DIMENSIONS, MESH_VARIABLES
from mesh.discrete.identities import identity_residuals
from mesh.files.io import mesh_hash
from tests.retyped_files import in_types


@pytest.fixture
def mesh_file(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> Path:
    path = tmp_path / "mesh.nc"
    write_mesh(icosahedral_mesh, path, history="made by a test")
    return path


def copy_as(source: Path, target: Path, file_format: str, **changes: object) -> Path:
    """Copy a mesh file in another format; `drop`, `add` and `single` change what it holds."""
    drop = changes.get("drop", ())
    with netCDF4.Dataset(source) as old, netCDF4.Dataset(target, "w", format=file_format) as new:
        new.setncatts({name: old.getncattr(name) for name in old.ncattrs()})
        for name, dimension in old.dimensions.items():
            new.createDimension(name, len(dimension))
        for name, variable in old.variables.items():
            if name not in drop:  # type: ignore[operator]
                new.createVariable(name, variable.dtype, variable.dimensions)[:] = variable[:]
        if changes.get("add"):
            new.createDimension("nSoilLevels", 3)
            new.createVariable("zMid", "f4", ("nSoilLevels",))[:] = 1.0
            new.createVariable("xtime", "S1", ("nSoilLevels",))
    return target


def test_round_trip_is_exact_and_silent(icosahedral_mesh: VoronoiMesh, mesh_file: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read = read_mesh(mesh_file)
    for variable in MESH_VARIABLES:
        np.testing.assert_array_equal(getattr(read, variable.name), getattr(icosahedral_mesh, variable.name))
    assert read.sphere_radius == 1.0
    assert mesh_hash(read) == mesh_hash(icosahedral_mesh)


def test_file_has_what_mpas_readers_expect(mesh_file: Path) -> None:
    with netCDF4.Dataset(mesh_file) as file:
        assert set(file.dimensions) == {*DIMENSIONS.values(), "Time", "nVertLevels", "nTracers"}
        assert len(file.dimensions["nVertLevels"]) == len(file.dimensions["nTracers"]) == 1
        assert file.dimensions["Time"].isunlimited()
        assert len(file.dimensions["Time"]) == 0
        assert {variable.file_name for variable in MESH_VARIABLES} < set(file.variables)
        assert {"indexToCellID", "indexToEdgeID", "indexToVertexID"} < set(file.variables)
        assert file["indexToCellID"][:].tolist() == list(range(1, 643))
        assert file.on_a_sphere == "YES"
        assert file.is_periodic == "NO"
        assert file.sphere_radius == 1.0
        assert file.mesh_spec == "1.0"
        assert file.Conventions == "MPAS"
        assert "made by a test" in file.history
        assert len(file.file_id) == 10
        assert file["cellsOnEdge"][:].min() == 1
        pentagons = file["nEdgesOnCell"][:] == 5
        assert np.all(file["edgesOnCell"][:][pentagons, 5] == 0)


@pytest.mark.parametrize("file_format", ["NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA", "NETCDF4"])
def test_all_formats_are_read(mesh_file: Path, tmp_path: Path, file_format: str) -> None:
    copy = copy_as(mesh_file, tmp_path / "copy.nc", file_format)
    assert mesh_hash(read_mesh(copy)) == mesh_hash(read_mesh(mesh_file))


def test_optional_variables_may_be_absent_and_others_present(mesh_file: Path, tmp_path: Path) -> None:
    optional = [variable.file_name for variable in MESH_VARIABLES if not variable.required]
    drop = [*optional, "indexToCellID", "indexToEdgeID", "indexToVertexID"]
    copy = copy_as(mesh_file, tmp_path / "copy.nc", "NETCDF3_64BIT_OFFSET", drop=drop, add=True)
    read, original = read_mesh(copy), read_mesh(mesh_file)
    assert len(drop) == 11
    np.testing.assert_allclose(read.lat_edge, original.lat_edge, atol=1e-15)
    assert np.all(read.mesh_density == 1.0)


def test_whatever_fills_the_rings_is_ignored(mesh_file: Path) -> None:
    before = mesh_hash(read_mesh(mesh_file))
    with netCDF4.Dataset(mesh_file, "r+") as file:
        pentagons = np.flatnonzero(file["nEdgesOnCell"][:] == 5)
        for cell in pentagons:
            file["edgesOnCell"][cell, 5] = 99999
            file["cellsOnCell"][cell, 5] = 643
    assert mesh_hash(read_mesh(mesh_file)) == before


def test_earth_sized_file_is_read(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    path = tmp_path / "earth.nc"
    write_mesh(icosahedral_mesh.scaled(6371229.0), path)
    read = read_mesh(path)
    assert read.sphere_radius == 6371229.0
    np.testing.assert_allclose(read.dc_edge, 6371229.0 * icosahedral_mesh.dc_edge, rtol=1e-15)


def test_noise_of_converters_is_accepted_with_a_warning(mesh_file: Path) -> None:
    random = np.random.default_rng(0)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        for name in ("areaCell", "kiteAreasOnVertex", "weightsOnEdge"):
            values = file[name][:]
            file[name][:] = values * (1 + 1e-7 * random.uniform(-1, 1, values.shape))
    with pytest.warns(MeshWarning, match=r"holds only to \d\.\de-0[78].*recompute"):
        read_mesh(mesh_file)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_mesh(mesh_file, recompute_metrics=True)


def test_recomputed_metrics_follow_from_generators_alone(mesh_file: Path) -> None:
    original = read_mesh(mesh_file)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        for name in ("areaCell", "dcEdge", "weightsOnEdge", "xVertex", "latCell"):
            file[name][:] = 7.0
    with pytest.raises(MeshError):
        read_mesh(mesh_file)
    rebuilt = read_mesh(mesh_file, recompute_metrics=True)
    for variable in MESH_VARIABLES:
        if not variable.name.startswith(("lon_", "angle_")):  # the same angle may stand as 0 or 2 pi
            np.testing.assert_allclose(
                getattr(rebuilt, variable.name), getattr(original, variable.name), atol=1e-12, err_msg=variable.name
            )


def edit(path: Path, name: str, index: object, value: float) -> None:
    with netCDF4.Dataset(path, "r+") as file:
        file[name][index] = value


def test_nan_coordinate_is_refused(mesh_file: Path) -> None:
    edit(mesh_file, "xCell", 3, np.nan)
    for recompute in (False, True):
        with pytest.raises(MeshError, match=r"mesh\.nc: cells 3 \(counted from 0\): xCell is not a finite number"):
            read_mesh(mesh_file, recompute)


def test_swapped_orientation_is_refused(mesh_file: Path) -> None:
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file["cellsOnVertex"][8, :] = file["cellsOnVertex"][8, ::-1]
    with pytest.raises(MeshError, match=r"mesh\.nc: vertices 8 \(counted from 0\): kiteAreasOnVertex differs from"):
        read_mesh(mesh_file)


NEEDED = ("cellsOnVertex",)


@pytest.mark.parametrize("name", [variable.file_name for variable in MESH_VARIABLES if variable.required])
def test_missing_variable_is_made(mesh_file: Path, tmp_path: Path, name: str) -> None:
    copy = copy_as(mesh_file, tmp_path / "copy.nc", "NETCDF4", drop=[name])
    if name in NEEDED:
        with pytest.raises(
            MeshError, match=rf"copy\.nc: the variable {name} is missing; a mesh file must have its tri"
        ):
            read_mesh(copy)
        return
    if name in ("xCell", "yCell", "zCell"):  # taken from longitudes and latitudes, which have other round-off
        expected, read = read_mesh(mesh_file), warned_of(copy, r"made (. more, )?")
        np.testing.assert_allclose(read.cell_points, expected.cell_points, rtol=0.0, atol=1e-15)
        return
    read = warned_of(copy, rf"copy\.nc: made .*{name}.*, which the file lacks, from the generators and triangles$")
    assert_same_arrays(read, read_mesh(mesh_file), 0.0)


def test_generators_and_triangles_are_enough(mesh_file: Path, tmp_path: Path) -> None:
    needed = ("xCell", "yCell", "zCell", "cellsOnVertex")
    drop = [variable.file_name for variable in MESH_VARIABLES if variable.file_name not in needed]
    copy = copy_as(mesh_file, tmp_path / "copy.nc", "NETCDF3_CLASSIC", drop=drop)
    assert_same_arrays(warned_of(copy, "edgesOnCell, .* and 22 more, which the file lacks"), read_mesh(mesh_file), 0.0)
    copy = copy_as(mesh_file, tmp_path / "copy.nc", "NETCDF3_CLASSIC", drop=[*drop, "zCell"])
    with pytest.raises(MeshError, match="xCell, yCell and zCell are missing, and lonCell and latCell too; a mesh file"):
        read_mesh(copy)


def warned_of(path: Path, words: str) -> VoronoiMesh:
    with pytest.warns(MeshWarning, match=words) as told:
        mesh = read_mesh(path)
    assert len(told) == 1
    assert "\n" not in str(told[0].message)
    return mesh


def assert_same_arrays(mesh: VoronoiMesh, expected: VoronoiMesh, tolerance: float) -> None:
    for variable in MESH_VARIABLES:
        found, wanted = getattr(mesh, variable.name), getattr(expected, variable.name)
        np.testing.assert_allclose(found, wanted, rtol=0.0, atol=tolerance, err_msg=variable.name)


def test_what_no_step_depends_on_is_replaced(mesh_file: Path) -> None:
    """Angles as a well-known converter leaves them, positions of edges, latitudes and longitudes."""
    original = read_mesh(mesh_file)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file["angleEdge"][5] += 0.4
        file["yEdge"][7] += 1e-3
        file["latVertex"][3] = 0.0
        file["boundaryVertex"][4] = 1
        file["meshDensity"][8] = np.nan
    words = (
        r"mesh\.nc: meshDensity is not finite everywhere and taken to be 1; replaced boundaryVertex \(a closed "
        r"sphere has none\), xEdge, yEdge or zEdge \(differed by up to 6\.4e-03 of the local size\), latVertex "
        r"\(differed by up to \d\.\de-01 rad\), angleEdge \(differed by up to 4\.0e-01 rad\) by what the generators "
        r"give$"
    )
    assert_same_arrays(warned_of(mesh_file, words), original, 1e-15)


def test_single_precision_is_taken_at_its_generators(mesh_file: Path, tmp_path: Path) -> None:
    single = in_types(mesh_file, tmp_path / "single.nc", f="f4")
    mesh = warned_of(single, "single.nc: coordinates are in single precision, so that all metrics are taken from them$")
    original = read_mesh(mesh_file)
    np.testing.assert_allclose(mesh.area_cell, original.area_cell, rtol=1e-5)
    assert np.abs(mesh.area_cell / original.area_cell - 1.0).max() > 1e-8
    assert max(identity_residuals(mesh).values()) < 1e-11


def test_a_damaged_generator_in_single_precision_is_refused(mesh_file: Path, tmp_path: Path) -> None:
    single = in_types(mesh_file, tmp_path / "single.nc", f="f4")
    x = np.abs(read_mesh(mesh_file).x_cell)
    cell = int(np.argmin(np.where(x > 1e-3, x, 1.0)))
    with netCDF4.Dataset(single, "r+") as file:
        file["xCell"][cell] *= -1.0
    with pytest.raises(MeshError, match=r"differs from what the generators give|lie against its tangent|clockwise"):
        read_mesh(single)


def test_longitudes_may_count_from_minus_180_and_in_degrees(mesh_file: Path) -> None:
    original = read_mesh(mesh_file)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        west = file["lonCell"][:] > np.pi
        file["lonCell"][west] = file["lonCell"][:][west] - 2.0 * np.pi
        file["lonVertex"][:] = np.degrees(file["lonVertex"][:])
        file["lonVertex"].units = "degrees_east"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read = read_mesh(mesh_file)
    assert_same_arrays(read, original, 1e-14)
    assert read.lon_cell.min() >= 0.0


@pytest.mark.parametrize(("file_format", "kind"), [("netcdf4", "NETCDF4"), ("cdf5", "NETCDF3_64BIT_DATA")])
def test_formats_are_written(icosahedral_mesh: VoronoiMesh, tmp_path: Path, file_format: str, kind: str) -> None:
    write_mesh(icosahedral_mesh, tmp_path / "mesh.nc", file_format=file_format)
    with netCDF4.Dataset(tmp_path / "mesh.nc") as file:
        assert file.data_model == kind
    assert mesh_hash(read_mesh(tmp_path / "mesh.nc")) == mesh_hash(icosahedral_mesh)
    write_mesh(icosahedral_mesh, tmp_path / "classic.nc", file_format="classic")
    assert (tmp_path / "classic.nc").read_bytes()[:4] == b"CDF\x02"


def test_unknown_format_is_refused(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    with pytest.raises(
        MeshError, match="there is no format of mesh files named 'hdf'; choose one of netcdf4, cdf5, cl"
    ):
        write_mesh(icosahedral_mesh, tmp_path / "mesh.nc", file_format="hdf")


def test_wrong_count_is_refused(mesh_file: Path) -> None:
    edit(mesh_file, "nEdgesOnCell", 40, 9)
    with pytest.raises(MeshError, match=r"cells 40 .*nEdgesOnCell is not the number of edges that cellsOnVertex gives"):
        read_mesh(mesh_file)


@pytest.mark.parametrize("value", [6371229.0, "large", -1.0, np.nan, None])
def test_the_coordinates_tell_the_radius(mesh_file: Path, value: object) -> None:
    original = read_mesh(mesh_file)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file.delncattr("sphere_radius")
        if value is not None:
            file.sphere_radius = value
    words = rf"sphere_radius is {'missing' if value is None else value}, but the coordinates lie at 1, which is used$"
    read = warned_of(mesh_file, words)
    assert read.sphere_radius == 1.0
    assert mesh_hash(read) == mesh_hash(original)


def test_coordinates_on_no_sphere_are_refused(mesh_file: Path) -> None:
    edit(mesh_file, "xCell", 30, 0.9)
    with pytest.raises(
        MeshError, match=r"cells 30 \(counted from 0\): the coordinates are not at sphere_radius = 1 from"
    ):
        read_mesh(mesh_file)


def test_a_triangle_has_three_corners(mesh_file: Path, tmp_path: Path) -> None:
    with netCDF4.Dataset(mesh_file) as old, netCDF4.Dataset(tmp_path / "quads.nc", "w") as new:
        new.setncatts({name: old.getncattr(name) for name in old.ncattrs()})
        for name, dimension in old.dimensions.items():
            new.createDimension(name, 4 if name == "vertexDegree" else len(dimension))
        for name, variable in old.variables.items():
            copy = new.createVariable(name, variable.dtype, variable.dimensions)
            copy[:] = np.resize(variable[:], copy.shape)
    with pytest.raises(MeshError, match=r"quads\.nc: cellsOnVertex has a dimension vertexDegree of 4 instead of 3$"):
        read_mesh(tmp_path / "quads.nc")


def test_a_sphere_is_no_plane(mesh_file: Path) -> None:
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file.on_a_sphere = "NO"
    with pytest.raises(MeshError, match="on_a_sphere is NO, but zCell is not zero"):
        read_mesh(mesh_file)


# The library reads zeros beyond the end of a file that is no HDF.
TRUNCATED = r"copy\.nc: (not a readable NetCDF file \(|\w+ \d+, \d+, \d+ and \d+ more \(counted from 0\): )"


@pytest.mark.parametrize("file_format", ["NETCDF3_64BIT_OFFSET", "NETCDF4"])
@pytest.mark.parametrize("part", [0.0, 0.001, 0.3, 0.7, 0.95])
def test_truncated_file_is_refused(mesh_file: Path, tmp_path: Path, file_format: str, part: float) -> None:
    copy = copy_as(mesh_file, tmp_path / "copy.nc", file_format)
    content = copy.read_bytes()
    copy.write_bytes(content[: int(part * len(content))])
    with pytest.raises(MeshError, match=TRUNCATED):
        read_mesh(copy)


def test_absent_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r"nothing\.nc: no such file"):
        read_mesh(tmp_path / "nothing.nc")


def test_interrupted_write_leaves_nothing(
    icosahedral_mesh: VoronoiMesh, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("mesh.files.io.fill_variables", interrupt)
    with pytest.raises(KeyboardInterrupt):
        write_mesh(icosahedral_mesh, tmp_path / "mesh.nc")
    assert list(tmp_path.iterdir()) == []


def test_unwritable_place_is_refused(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    with pytest.raises(MeshError, match=r"absent/mesh\.nc: cannot be written \(No such file or directory\); choose"):
        write_mesh(icosahedral_mesh, tmp_path / "absent" / "mesh.nc")


COMMUNITY_MESH = Path(__file__).parents[4] / "shared" / "meshes" / "x1.2562.grid.nc"


@pytest.mark.skipif(not COMMUNITY_MESH.exists(), reason="the community mesh is not beside the checkout")
def test_community_mesh_is_read_with_a_warning(tmp_path: Path) -> None:
    path = shutil.copy(COMMUNITY_MESH, tmp_path / "x1.nc")
    with pytest.warns(MeshWarning, match="sum of kites = areaCell holds only to 7.7e-08"):
        mesh = read_mesh(path)
    rebuilt = read_mesh(path, recompute_metrics=True)
    np.testing.assert_allclose(rebuilt.area_cell, mesh.area_cell, rtol=2e-7)
    np.testing.assert_allclose(rebuilt.weights_on_edge, mesh.weights_on_edge, atol=1e-7)
    assert BY_NAME["weights_on_edge"].file_name == "weightsOnEdge"


@pytest.mark.parametrize("index", [2**32 + 7, -(2**32) + 7, 2**40, -9])
def test_wide_integers_are_not_cut_to_narrow_ones(mesh_file: Path, tmp_path: Path, index: int) -> None:
    """2**32 + 7 in 32 bits is 7, a cell that exists."""
    wide = in_types(mesh_file, tmp_path / "wide.nc", i="i8")
    assert_same_arrays(read_mesh(wide), read_mesh(mesh_file), 0.0)
    with netCDF4.Dataset(wide, "r+") as file:
        file["cellsOnEdge"][11, 0] = index
    with pytest.raises(MeshError, match=r"wide\.nc: edges 11 \(.*\): cellsOnEdge holds an index outside 1 to 642"):
        read_mesh(wide)


def test_what_was_sorted_is_named(mesh_file: Path) -> None:
    original = read_mesh(mesh_file)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        file["edgesOnCell"][40, :6] = file["edgesOnCell"][40, 5::-1]
    assert_same_arrays(warned_of(mesh_file, r"mesh\.nc: sorted edgesOnCell$"), original, 0.0)


@pytest.mark.parametrize("fill", [-3, 0, 5, 99_999])
@pytest.mark.parametrize("rings", ["cellsOnCell", "edgesOnCell", "verticesOnCell", "edgesOnEdge"])
def test_what_stands_beyond_a_ring_is_passed_over(mesh_file: Path, rings: str, fill: int) -> None:
    original = read_mesh(mesh_file)
    with netCDF4.Dataset(mesh_file, "r+") as file:
        counts, values = file["nEdgesOnEdge" if rings == "edgesOnEdge" else "nEdgesOnCell"][:], file[rings][:]
        beyond = np.arange(values.shape[1]) >= counts[:, None]
        assert beyond.any()
        file[rings][:] = np.where(beyond, fill, values)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_same_arrays(read_mesh(mesh_file), original, 0.0)
