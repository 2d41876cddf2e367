"""Commands on planes: meshes of hexagons, their quality, runs, comparison with the exact solution; and refusals."""

import json
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from mesh import MeshRequest, MeshWarning, hexagon_mesh, polygon_mesh, read_mesh
from mesh.conventions import MESH_VARIABLES
from postprocess.figures import compare_maps, paper
from tests.planar_tool import write_planar_file
from tests.trisk.conftest import Call
from tests.under_mpiexec import needs_mpi, on_processes

LENGTHS = "1e6,866025.4037844386"
IN_BOX = ("--plane", "1e6,8e5", "--periodic", "none", "--cells", 60)
RUN = ("--days", 0.02, "--snapshot-hours", 0.24, "--diagnostics-hours", 0.24, "--dt", 216)


@pytest.fixture(scope="module")
def plane_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from mesh import write_mesh

    path = tmp_path_factory.mktemp("plane") / "plane.nc"
    write_mesh(hexagon_mesh((1e6, 5e5 * np.sqrt(3.0)), (12, 12)), path)
    return path


def test_a_mesh_is_made_and_measured(trisk: Call, tmp_path: Path) -> None:
    path = tmp_path / "channel.nc"
    code, out, err = trisk("mesh", "--plane", LENGTHS, "--periodic", "x", "--hexagons", "10,10", "-o", path)
    assert (code, err) == (0, "")
    assert "1.000000" in out
    made, expected = read_mesh(path), hexagon_mesh((1e6, 866025.4037844386), (10, 10), "x")
    for variable in MESH_VARIABLES:
        np.testing.assert_array_equal(getattr(made, variable.name), getattr(expected, variable.name))
    measured = json.loads(trisk("quality", path, "--json")[1])
    assert measured["q_min"] == pytest.approx(1.0)
    assert measured["residual"] < 1e-13


def test_quality_of_a_file_of_the_community(trisk: Call, tmp_path: Path) -> None:
    write_planar_file(tmp_path / "hexagons.nc", 6, 8, 1e4)
    with pytest.warns(MeshWarning, match="made edgesOnEdge"):
        code, out, _ = trisk("quality", tmp_path / "hexagons.nc", "--json")
    assert code == 0
    assert json.loads(out)["cells"] == 48


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--plane", "1e6,1e6", "--hexagons", "10,10"), "866025.4038 m high, not 1000000 m"),
        (("--plane", LENGTHS), "a mesh on a plane needs cells; give --cells N, or --hexagons NX,NY"),
        (("--hexagons", "10,10", "--cells", 42), "--periodic and --hexagons go with --plane LX,LY"),
        (("--plane", LENGTHS, "--hexagons", "10,10", "--cells", 42), "only --plane and --periodic go with --hexagons"),
        (("--plane", LENGTHS, "--hexagons", "10,10", "--coast-width", 10), "--coast-width does not go with --plane"),
        (("--plane", LENGTHS, "--cells", 42, "--coast-factor", 3), "--coast-factor does not go with --plane; leave"),
        (("--plane", LENGTHS, "--hexagons", "10,10", "--coast", "a.geojson"), "hexagons do not follow the walls"),
        (
            ("--plane", LENGTHS, "--cells", 42, "--coast", "a.geojson"),
            "cannot be periodic, which it is in xy; give --pe",
        ),
        ((*IN_BOX, "--coast", "world-ocean"), "--coast is world-ocean; on a plane give a polygon in metres"),
        ((*IN_BOX, "--coast", "none.geojson"), "none.geojson: No such file or directory; give a GeoJSON file"),
        (("--plane", LENGTHS, "--hexagons", "10,1.5"), "give two whole numbers with a comma between them"),
        (("--plane", "nan,1e6", "--hexagons", "10,10"), "give two finite numbers with a comma between them"),
    ],
)
def test_what_cannot_be_made_is_told_in_a_line(
    trisk: Call, tmp_path: Path, options: tuple[object, ...], words: str
) -> None:
    code, _, err = trisk("mesh", *options, "-o", tmp_path / "plane.nc")
    assert code == 2
    assert words in err
    assert err.count("\n") == 1
    assert not (tmp_path / "plane.nc").exists()


def geojson(path: Path, *polygons: object) -> Path:
    path.write_text(json.dumps({"type": "MultiPolygon", "coordinates": polygons}))
    return path


L_SHAPE = [[[0, 0], [1e6, 0], [1e6, 3e5], [4e5, 3e5], [4e5, 8e5], [0, 8e5, 7.0], [0, 0]]]


def test_a_polygon_is_filled(trisk: Call, tmp_path: Path) -> None:
    pytest.importorskip("shapely")
    path, output = geojson(tmp_path / "room.geojson", L_SHAPE), tmp_path / "room.nc"
    code, out, err = trisk("mesh", *IN_BOX, "--coast", path, "-o", output)
    assert (code, err.count("\n")) == (0, 1), err
    assert "of 1e-08 spacings" in err
    assert "residual" in out
    made = read_mesh(output)
    assert made.area_cell.sum() == pytest.approx(5e11, rel=1e-13)
    expected = polygon_mesh([[place[:2] for place in L_SHAPE[0]]], MeshRequest(60, plane=(1e6, 8e5), periodic="none"))
    np.testing.assert_array_equal(made.cell_points, expected.cell_points)
    assert json.loads(trisk("quality", output, "--json")[1])["cells"] == 60


@pytest.mark.parametrize(
    ("polygons", "words"),
    [
        ([L_SHAPE, L_SHAPE], "room.geojson: holds 2 polygons, and a mesh fills one; leave the others out"),
        ([[[[0, 0], [1e6, 0], [0, 9e5]]]], "ring 0 of the polygon of"),
        ([[[[0, 0], [1e6, 0], [0, 9e5]]]], "x = 0, y = 900000 m, outside of the plane of 1e+06 by 800000 m"),
        ([[[[0, 0], [1e6, 8e5], [1e6, 0], [0, 8e5]]]], "is not simple (Self-intersection[500000 400000])"),
        ([[[[0, 0], [1e6, 8e5]]]], "has 2 points; give at least 3"),
    ],
)
def test_files_without_a_polygon_in_the_plane_are_refused(
    trisk: Call, tmp_path: Path, polygons: list[object], words: str
) -> None:
    pytest.importorskip("shapely")
    path = geojson(tmp_path / "room.geojson", *polygons)
    code, _, err = trisk("mesh", *IN_BOX, "--coast", path, "-o", tmp_path / "room.nc")
    assert code == 2
    assert words in err
    assert err.count("\n") == 1
    assert not (tmp_path / "room.nc").exists()


@pytest.fixture
def run(trisk: Call, plane_file: Path, tmp_path: Path) -> Path:
    code, out, err = trisk("run", "inertia-gravity-wave", "--mesh", plane_file, *RUN, "-o", tmp_path / "run", "--quiet")
    assert (code, out, err) == (0, "", "")
    return tmp_path / "run"


def test_a_run_is_compared_with_the_exact_solution(trisk: Call, run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(compare_maps, "MAP_FIELDS", {"thickness": compare_maps.MAP_FIELDS["thickness"]})
    monkeypatch.setattr(compare_maps, "DOTS_PER_INCH", 40)
    monkeypatch.setattr(paper, "COLUMNS", 40)
    code, out, err = trisk("compare", run, "--json")
    assert (code, err) == (0, "")
    assert '"exact solution"' in out
    found = json.loads(out)
    assert len(found["maps"]) == 2
    assert all(Path(path).is_file() for path in found["maps"])
    code, out, _ = trisk("compare", run, "--reference", shutil.copytree(run, run.parent / "again"))
    assert code == 0
    assert "latitude" not in out


@pytest.mark.slow
def test_a_run_is_drawn_filmed_and_converted(trisk: Call, run: Path, tmp_path: Path) -> None:
    code, out, err = trisk("plot", run)
    assert (code, err) == (0, "")
    assert all(Path(path).is_file() for path in out.split())
    for words in (
        ("film", run, "--field", "thickness", "-o", tmp_path / "film.gif", "--size", "320,180"),
        ("convert", run, "--to", "ugrid", "-o", tmp_path / "run.nc"),
        ("convert", run, "--to", "vtk", "-o", tmp_path / "vtk"),
    ):
        code, _, err = trisk(*words, "--quiet")
        assert (code, err) == (0, "")
        assert Path(words[words.index("-o") + 1]).exists()


@pytest.mark.slow
def test_a_study_needs_no_more_than_the_case(trisk: Call, tmp_path: Path) -> None:
    options = ("--cells", 64, "--days", 0.02, "--quiet")
    code, out, err = trisk("study", "mesh", "inertia-gravity-wave", *options, "-o", tmp_path / "study")
    assert (code, out, err) == (0, "", "")
    assert "hexagons,ringler2010,64" in (tmp_path / "study" / "study.csv").read_text()


def test_what_is_of_the_sphere_alone_is_refused_in_a_sentence(
    trisk: Call, run: Path, plane_file: Path, tmp_path: Path
) -> None:
    for words in (
        ("film", run, "--field", "thickness", "--centre", "270,0", "-o", tmp_path / "film.gif"),
        ("film", run, "--field", "thickness", "--projection", "mollweide", "-o", tmp_path / "film.gif"),
        ("cull", plane_file, "--keep", "0,10,0,10", "-o", tmp_path / "part.nc"),
        ("mesh", "--nested", plane_file, "--cells", 400, "-o", tmp_path / "nested.nc"),
        ("bench", "--mesh", plane_file),
        ("run", "inertia-gravity-wave", "--cells", 42, "-o", tmp_path / "other"),
        ("run", "williamson2", "--mesh", plane_file, "-o", tmp_path / "other"),
        ("adapt", "inertia-gravity-wave", "--cells", 42, "--fine", 162, "-o", tmp_path / "adapted"),
        ("reference", "inertia-gravity-wave", "-o", tmp_path / "reference.nc"),
    ):
        code, _, err = trisk(*words)
        assert code == 2, (words, err)
        assert "plane" in err, (words, err)
        assert err.strip().count("\n") == (words[0] == "bench"), (words, err)  # which tells first what it times


def test_planes_are_partitioned(trisk: Call, plane_file: Path, tmp_path: Path) -> None:
    pytest.importorskip("pymetis")
    code, _, err = trisk("partition", plane_file, "--blocks", 4, "-o", tmp_path)
    assert (code, err) == (0, "")
    assert {path.name for path in tmp_path.iterdir()} == {"graph.info", "graph.info.part.4", "blocks.png"}


def test_the_case_is_listed(trisk: Call) -> None:
    assert "inertia-" in trisk("cases")[1]
    code, out, _ = trisk("cases", "inertia-gravity-wave")
    assert code == 0
    assert "coriolis_parameter" in out
    assert "radius" not in out


@needs_mpi
def test_processes_share_a_run_on_a_plane(run: Path, plane_file: Path, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "trisk", "run", "inertia-gravity-wave", "--mesh", plane_file, *RUN]
    code, output = on_processes(2, [*command, "-o", tmp_path / "shared", "--quiet"])
    assert code == 0, output
    for name in ("history.nc", "diagnostics.nc"):
        assert (tmp_path / "shared" / name).read_bytes() == (run / name).read_bytes()
