"""Every variable of a mesh file: units, meaning, and values by textbook formulae from longitude and latitude.

The formulae are others than those of the package: haversines for arcs, l'Huilier's theorem for areas, bearings for
angles, and for the weights the sum of equation (33) of Thuburn et al. (2009) edge by edge.
"""

from pathlib import Path

import netCDF4
import numpy as np
import pytest

from mesh import VoronoiMesh, write_mesh

RADIUS = 6371220.0

CELL, EDGE, VERTEX = ("nCells",), ("nEdges",), ("nVertices",)
VARIABLES = {
    **{
        f"{short}{place}": ((f"n{places}",), "rad", f"{long} of {places.lower()}")
        for place, places in (("Cell", "Cells"), ("Edge", "Edges"))
        for short, long in (("lat", "latitude"), ("lon", "longitude"))
    },
    "latVertex": (VERTEX, "rad", "latitude of vert"),
    "lonVertex": (VERTEX, "rad", "longitude of vert"),
    **{
        f"{axis}{place}": (dimension, "m", f"Cartesian {axis} of {place.lower()[:4]}")
        for place, dimension in (("Cell", CELL), ("Edge", EDGE), ("Vertex", VERTEX))
        for axis in "xyz"
    },
    "nEdgesOnCell": (CELL, "1", "number of edges of a cell"),
    "cellsOnCell": (("nCells", "maxEdges"), "1", "cells across the edges of a cell"),
    "edgesOnCell": (("nCells", "maxEdges"), "1", "edges of a cell, counter-clockwise"),
    "verticesOnCell": (("nCells", "maxEdges"), "1", "vertices after each edge of a cell"),
    "nEdgesOnEdge": (EDGE, "1", "number of edges"),
    "edgesOnEdge": (("nEdges", "maxEdges2"), "1", "reconstruct a tangential velocity"),
    "weightsOnEdge": (("nEdges", "maxEdges2"), "1", "weights of the tangential velocity"),
    "cellsOnEdge": (("nEdges", "TWO"), "1", "cells that an edge's normal leaves and enters"),
    "verticesOnEdge": (("nEdges", "TWO"), "1", "vertices at the tail and head of the tangent"),
    "cellsOnVertex": (("nVertices", "vertexDegree"), "1", "corners of a triangle"),
    "edgesOnVertex": (("nVertices", "vertexDegree"), "1", "edges that meet at a vertex"),
    "kiteAreasOnVertex": (("nVertices", "vertexDegree"), "m2", "part of a cell in a triangle"),
    "areaCell": (CELL, "m2", "area of a cell"),
    "areaTriangle": (VERTEX, "m2", "area of a Delaunay triangle"),
    "dcEdge": (EDGE, "m", "distance between the cell centres of an edge"),
    "dvEdge": (EDGE, "m", "distance between the vertices of an edge"),
    "angleEdge": (EDGE, "rad", "angle of an edge's normal, counter-clockwise from east"),
    "meshDensity": (CELL, "1", "density that the mesh was generated for"),
    "boundaryVertex": (VERTEX, "1", "1 at the boundary, 0 within"),
}


class MeshFile:
    """Variables of a mesh file as they stand there, indices counted from 1."""

    def __init__(self, path: Path) -> None:
        with netCDF4.Dataset(path) as file:
            file.set_auto_mask(False)
            self.values = {name: np.asarray(variable[:]) for name, variable in file.variables.items()}
            self.radius = float(file.sphere_radius)

    def __getattr__(self, name: str) -> np.ndarray:
        return self.values[name]

    def place(self, kind: str, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Longitude and latitude of the entities with these numbers."""
        return self.values[f"lon{kind}"][numbers - 1], self.values[f"lat{kind}"][numbers - 1]

    def ring(self, name: str, cell: int) -> np.ndarray:
        return self.values[name][cell - 1, : self.nEdgesOnCell[cell - 1]]


Place = tuple[np.ndarray, np.ndarray]


def haversine(a: Place, b: Place) -> np.ndarray:
    """Arc between places on the unit sphere."""
    part = np.sin(0.5 * (b[1] - a[1])) ** 2 + np.cos(a[1]) * np.cos(b[1]) * np.sin(0.5 * (b[0] - a[0])) ** 2
    return 2.0 * np.arcsin(np.sqrt(part))


def lhuilier(a: Place, b: Place, c: Place) -> np.ndarray:
    """Area of triangles on the unit sphere."""
    sides = haversine(a, b), haversine(b, c), haversine(c, a)
    s = 0.5 * sum(sides)
    product = np.tan(0.5 * s)
    for side in sides:
        product = product * np.tan(0.5 * np.maximum(s - side, 0.0))
    return 4.0 * np.arctan(np.sqrt(product))


def bearing(a: Place, b: Place) -> np.ndarray:
    """Direction at a of the great circle to b, clockwise from north."""
    turn = b[0] - a[0]
    east = np.sin(turn) * np.cos(b[1])
    return np.arctan2(east, np.cos(a[1]) * np.sin(b[1]) - np.sin(a[1]) * np.cos(b[1]) * np.cos(turn))


@pytest.fixture(scope="module")
def paths(small_mesh: VoronoiMesh, tmp_path_factory: pytest.TempPathFactory) -> dict[float, Path]:
    folder = tmp_path_factory.mktemp("files")
    found = {}
    for radius in (1.0, RADIUS):
        found[radius] = folder / f"{radius:g}.nc"
        write_mesh(small_mesh.scaled(radius), found[radius], "made for a test")
    return found


@pytest.fixture(scope="module", params=[1.0, RADIUS], ids=["unit", "earth"])
def file(request: pytest.FixtureRequest, paths: dict[float, Path]) -> MeshFile:
    return MeshFile(paths[request.param])


@pytest.fixture(scope="module")
def unit(paths: dict[float, Path]) -> MeshFile:
    return MeshFile(paths[1.0])


@pytest.mark.parametrize("name", VARIABLES)
def test_units_dimensions_and_meaning(name: str, paths: dict[float, Path]) -> None:
    dimensions, units, meaning = VARIABLES[name]
    with netCDF4.Dataset(paths[1.0]) as found:
        assert found[name].dimensions == dimensions
        assert found[name].units == units
        assert meaning in found[name].long_name
        assert found[name].dtype == ("i4" if units == "1" and name not in ("weightsOnEdge", "meshDensity") else "f8")


def test_dimensions_and_attributes(paths: dict[float, Path]) -> None:
    for radius, path in paths.items():
        with netCDF4.Dataset(path) as found:
            sizes = {name: len(dimension) for name, dimension in found.dimensions.items() if name != "Time"}
            assert sizes == {
                **{"nCells": 162, "nEdges": 480, "nVertices": 320, "maxEdges": 6, "maxEdges2": 12},
                **{"TWO": 2, "vertexDegree": 3, "nVertLevels": 1, "nTracers": 1},
            }
            assert found.sphere_radius == radius
            assert (found.on_a_sphere, found.is_periodic, found.mesh_spec) == ("YES", "NO", "1.0")
            assert found.Conventions == "MPAS"
            assert found.history.endswith(" UTC: made for a test")
            assert found.density_name == "uniform"
            for place, count in (("Cell", 162), ("Edge", 480), ("Vertex", 320)):
                np.testing.assert_array_equal(found[f"indexTo{place}ID"][:], np.arange(1, count + 1))


def test_values_name_their_coordinates(paths: dict[float, Path]) -> None:
    with netCDF4.Dataset(paths[1.0]) as found:
        for name in VARIABLES:
            if name.startswith(("lon", "lat")):
                assert found[name].standard_name == {"lon": "longitude", "lat": "latitude"}[name[:3]]
            else:
                place = {"nCells": "Cell", "nEdges": "Edge", "nVertices": "Vertex"}[found[name].dimensions[0]]
                assert found[name].coordinates == f"lon{place} lat{place}"


@pytest.mark.parametrize("place", ["Cell", "Edge", "Vertex"])
def test_coordinates_agree(file: MeshFile, place: str) -> None:
    lon, lat = (file.values[f"{name}{place}"] for name in ("lon", "lat"))
    assert 0.0 <= lon.min() < 0.3
    assert 6.0 < lon.max() < 2.0 * np.pi
    assert np.abs(lat).max() <= 0.5 * np.pi
    x, y, z = (file.values[f"{axis}{place}"] / file.radius for axis in "xyz")
    np.testing.assert_allclose(x, np.cos(lat) * np.cos(lon), rtol=0, atol=1e-15)
    np.testing.assert_allclose(y, np.cos(lat) * np.sin(lon), rtol=0, atol=1e-15)
    np.testing.assert_allclose(z, np.sin(lat), rtol=0, atol=1e-15)


def test_lengths_are_arcs(file: MeshFile) -> None:
    cells, vertices = file.cellsOnEdge, file.verticesOnEdge
    between_cells = haversine(file.place("Cell", cells[:, 0]), file.place("Cell", cells[:, 1]))
    between_vertices = haversine(file.place("Vertex", vertices[:, 0]), file.place("Vertex", vertices[:, 1]))
    np.testing.assert_allclose(file.dcEdge, file.radius * between_cells, rtol=1e-12)
    np.testing.assert_allclose(file.dvEdge, file.radius * between_vertices, rtol=1e-12)


def test_edges_are_midway_and_vertices_equally_far_from_their_cells(unit: MeshFile) -> None:
    for k in (0, 1):
        distance = haversine(unit.place("Edge", unit.indexToEdgeID), unit.place("Cell", unit.cellsOnEdge[:, k]))
        np.testing.assert_allclose(distance, 0.5 * unit.dcEdge, rtol=1e-12)
    vertices = unit.place("Vertex", unit.indexToVertexID)
    first = haversine(vertices, unit.place("Cell", unit.cellsOnVertex[:, 0]))
    for k in (1, 2):
        np.testing.assert_allclose(haversine(vertices, unit.place("Cell", unit.cellsOnVertex[:, k])), first, rtol=1e-12)
    assert first.max() < 0.7 * unit.dcEdge.max()


def test_areas_by_the_sides_of_triangles(file: MeshFile) -> None:
    corners = [file.place("Cell", file.cellsOnVertex[:, k]) for k in range(3)]
    np.testing.assert_allclose(file.areaTriangle, file.radius**2 * lhuilier(*corners), rtol=1e-11)
    vertices = file.place("Vertex", file.indexToVertexID)
    for k in range(3):
        before, after = file.edgesOnVertex[:, k], file.edgesOnVertex[:, (k + 1) % 3]
        kite = lhuilier(corners[k], vertices, file.place("Edge", before))
        kite = kite + lhuilier(corners[k], file.place("Edge", after), vertices)
        np.testing.assert_allclose(file.kiteAreasOnVertex[:, k], file.radius**2 * kite, rtol=1e-11)
    for cell in file.indexToCellID:
        ring = file.ring("verticesOnCell", cell)
        parts = lhuilier(
            file.place("Cell", np.full(len(ring), cell)),
            file.place("Vertex", ring),
            file.place("Vertex", np.roll(ring, -1)),
        )
        assert file.areaCell[cell - 1] == pytest.approx(file.radius**2 * parts.sum(), rel=1e-11)
    assert file.areaCell.sum() == pytest.approx(4.0 * np.pi * file.radius**2, rel=1e-13)


def test_angles_of_normals(unit: MeshFile) -> None:
    """From the edge to the cell that the normal enters; east is 90 degrees clockwise from north."""
    towards = bearing(unit.place("Edge", unit.indexToEdgeID), unit.place("Cell", unit.cellsOnEdge[:, 1]))
    off = unit.angleEdge - (0.5 * np.pi - towards)
    np.testing.assert_allclose(np.sin(off), 0.0, atol=1e-12)
    assert np.all(np.cos(off) > 0.0)
    assert np.all(np.abs(unit.angleEdge) <= np.pi)


def test_tangents_point_to_the_left_of_normals(unit: MeshFile) -> None:
    tail, head = (unit.place("Vertex", unit.verticesOnEdge[:, k]) for k in (0, 1))
    edge = unit.place("Edge", unit.indexToEdgeID)
    for towards, sign in ((bearing(edge, head), 1.0), (bearing(edge, tail), -1.0)):
        np.testing.assert_allclose(np.sin(0.5 * np.pi - towards - unit.angleEdge), sign, atol=1e-10)


def test_rings_run_counter_clockwise_and_name_each_other(unit: MeshFile) -> None:
    for cell in unit.indexToCellID:
        edges, cells, vertices = (unit.ring(f"{name}OnCell", cell) for name in ("edges", "cells", "vertices"))
        n = len(edges)
        here = unit.place("Cell", np.full(n + 1, cell))
        for kind, ring in (("Edge", edges), ("Cell", cells), ("Vertex", vertices)):
            steps = -np.diff(bearing(here, unit.place(kind, np.append(ring, ring[0])))) % (2.0 * np.pi)
            assert np.all((steps > 0.2) & (steps < 2.0)), (cell, kind)
        for j, edge in enumerate(edges):
            assert set(unit.cellsOnEdge[edge - 1]) == {cell, cells[j]}
            assert set(unit.verticesOnEdge[edge - 1]) == {vertices[j], vertices[j - 1]}
    assert sorted(unit.nEdgesOnCell) == [5] * 12 + [6] * 150
    for vertex in unit.indexToVertexID:
        cells, edges = unit.cellsOnVertex[vertex - 1], unit.edgesOnVertex[vertex - 1]
        here = unit.place("Vertex", np.full(3, vertex))
        for kind, ring in (("Cell", cells), ("Edge", edges)):
            steps = -np.diff(bearing(here, unit.place(kind, ring))) % (2.0 * np.pi)
            assert np.all(np.abs(steps - 2.0 * np.pi / 3.0) < 0.7)
        for j in range(3):
            shared = set(unit.cellsOnEdge[edges[j] - 1]) & set(unit.cellsOnEdge[edges[(j + 1) % 3] - 1])
            assert shared == {cells[j]}
    assert not unit.boundaryVertex.any()


def test_weights_by_the_sum_over_kites(unit: MeshFile) -> None:
    """Round each cell of an edge, the share of the area passed less one half, with the signs of both edges."""
    for edge in unit.indexToEdgeID:
        expected: dict[int, float] = {}
        for side, cell in enumerate(unit.cellsOnEdge[edge - 1]):
            edges, vertices = list(unit.ring("edgesOnCell", cell)), list(unit.ring("verticesOnCell", cell))
            n, start = len(edges), edges.index(edge)
            passed = 0.0
            for step in range(1, n):
                vertex = vertices[(start + step - 1) % n]
                kite = unit.kiteAreasOnVertex[vertex - 1, list(unit.cellsOnVertex[vertex - 1]).index(cell)]
                passed += kite / unit.areaCell[cell - 1]
                other = edges[(start + step) % n]
                outward = 1.0 if unit.cellsOnEdge[other - 1, 0] == cell else -1.0
                tangent = 1.0 if side == 0 else -1.0
                ratio = unit.dvEdge[other - 1] / unit.dcEdge[edge - 1]
                expected[other] = expected.get(other, 0.0) + (0.5 - passed) * outward * tangent * ratio
        count = unit.nEdgesOnEdge[edge - 1]
        assert count == len(expected)
        found = dict(zip(unit.edgesOnEdge[edge - 1, :count], unit.weightsOnEdge[edge - 1, :count], strict=True))
        assert found.keys() == expected.keys()
        for other, weight in expected.items():
            assert found[other] == pytest.approx(weight, abs=1e-12)
        assert not unit.edgesOnEdge[edge - 1, count:].any()
        assert not unit.weightsOnEdge[edge - 1, count:].any()


def test_weights_reconstruct_a_rotation(unit: MeshFile) -> None:
    """The sign of the tangent: wind of a rotation about a tilted axis, known at every edge."""
    axis = np.array([0.3, -0.5, 0.8])
    points = np.stack([unit.xEdge, unit.yEdge, unit.zEdge], axis=1)
    wind = np.cross(axis, points)
    lon, lat = unit.lonEdge, unit.latEdge
    east = np.stack([-np.sin(lon), np.cos(lon), 0.0 * lon], axis=1)
    north = np.cross(points, east)
    angle = unit.angleEdge[:, None]
    normal = (wind * (np.cos(angle) * east + np.sin(angle) * north)).sum(axis=1)
    tangential = (wind * (-np.sin(angle) * east + np.cos(angle) * north)).sum(axis=1)
    assert np.abs(lat).max() < 1.5708
    found = (unit.weightsOnEdge * normal[np.maximum(unit.edgesOnEdge - 1, 0)]).sum(axis=1)
    assert np.sqrt(np.mean((found - tangential) ** 2)) < 0.05 * np.sqrt(np.mean(tangential**2))


def test_density_of_the_file_is_equation_12(tmp_path: Path) -> None:
    """Ju, Ringler and Gunzburger (2011): 3^4 within 30 degrees of 270 E, 30 N, one beyond 45 degrees."""
    from mesh import scvt_mesh

    write_mesh(scvt_mesh(162, density="refined-circle", tolerance=1e-2), tmp_path / "mesh.nc")
    found = MeshFile(tmp_path / "mesh.nc")
    away = np.minimum(np.abs(found.lonCell - 1.5 * np.pi), 2.0 * np.pi - np.abs(found.lonCell - 1.5 * np.pi))
    distance = np.degrees(np.sqrt(away**2 + (found.latCell - np.pi / 6.0) ** 2))
    s = np.clip((distance - 30.0) / 15.0, 0.0, 1.0)
    np.testing.assert_allclose(found.meshDensity, (3.0 * (1.0 - s) + s) ** 4, rtol=1e-12)
    assert found.meshDensity.max() == 81.0
    assert found.meshDensity.min() == 1.0
    with netCDF4.Dataset(tmp_path / "mesh.nc") as file:
        assert file.density_name == "refined-circle"
