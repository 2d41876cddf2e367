"""Legal variants of mesh files, and what comes of them: python tests/reliability/legal_variants.py COUNT [SEED].

Programs differ in where rings start, how they turn, what fills them, how arrays are paired, which way normals point, in
types, formats, radii, ranges of longitude, and in what they leave out. Each variant must give the run of test case 5 of
the original file, to `RUN_TOLERANCE`, or say in one sentence what is missing. Exits with 1 if any does otherwise.
"""

import functools
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np

from cases import Williamson5
from mesh import MeshError, VoronoiMesh, mesh_from_points, read_mesh, scvt_mesh, write_mesh
from mesh.conventions import MESH_VARIABLES
from mesh.safe_files import dataset
from swe import Simulation

RUN_TOLERANCE = 1e-12
"""Largest difference of thickness and velocity after the run, by their largest values."""

HOURS = 2.0
TIME_STEP = 600.0
FORMATS = ("NETCDF4", "NETCDF4_CLASSIC", "NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA")
NEEDED = ("xCell", "yCell", "zCell", "cellsOnVertex")

Arrays = dict[str, np.ndarray]
Random = np.random.Generator


class Variant:
    """The content of a mesh file, to be varied; `flipped` marks edges whose normals were turned round."""

    def __init__(self, path: Path) -> None:
        with dataset(path) as file:
            file.set_auto_mask(False)
            self.sizes = {name: len(dimension) for name, dimension in file.dimensions.items() if name != "Time"}
            self.dimensions = {name: variable.dimensions for name, variable in file.variables.items()}
            self.arrays: Arrays = {name: np.asarray(variable[:]) for name, variable in file.variables.items()}
            self.attributes: dict[str, Any] = {name: file.getncattr(name) for name in file.ncattrs()}
        self.units: dict[str, str] = {}
        self.format = "NETCDF4"
        self.flipped = np.zeros(self.sizes["nEdges"], bool)

    def write(self, path: Path) -> None:
        with netCDF4.Dataset(path, "w", format=self.format) as file:
            file.setncatts(self.attributes)
            for name, size in self.sizes.items():
                file.createDimension(name, size)
            for name, values in self.arrays.items():
                variable = file.createVariable(name, values.dtype, self.dimensions[name])
                if name in self.units:
                    variable.units = self.units[name]
                variable[:] = values


def rotate_rings(variant: Variant, random: Random) -> None:
    """Rings of cells start anywhere."""
    arrays, counts = variant.arrays, variant.arrays["nEdgesOnCell"]
    start = random.integers(0, counts)
    for name in ("edgesOnCell", "cellsOnCell", "verticesOnCell"):
        arrays[name] = _taken(arrays[name], counts, lambda j, n: (j + start[:, None]) % n)


def turn_rings(variant: Variant, random: Random) -> None:
    """Some rings of cells run clockwise."""
    arrays, counts = variant.arrays, variant.arrays["nEdgesOnCell"]
    turned = random.random(len(counts)) < 0.5
    for name in ("edgesOnCell", "cellsOnCell", "verticesOnCell"):
        arrays[name] = _taken(arrays[name], counts, lambda j, n: np.where(turned[:, None], (n - j) % n, j))


def pair_vertices_before(variant: Variant, random: Random) -> None:
    """Vertices of a cell lie before the edges of the same number, not behind."""
    arrays, counts = variant.arrays, variant.arrays["nEdgesOnCell"]
    arrays["verticesOnCell"] = _taken(arrays["verticesOnCell"], counts, lambda j, n: (j - 1) % n)


def shuffle_neighbours(variant: Variant, random: Random) -> None:
    """Neighbours of a cell stand in any order."""
    counts = variant.arrays["nEdgesOnCell"]
    keys = random.random(variant.arrays["cellsOnCell"].shape)
    beyond = np.arange(keys.shape[1]) >= counts[:, None]
    order = np.argsort(np.where(beyond, 2.0, keys), axis=1)
    variant.arrays["cellsOnCell"] = np.take_along_axis(variant.arrays["cellsOnCell"], order, axis=1)


def shuffle_corners(variant: Variant, random: Random) -> None:
    """Corners of a triangle start anywhere and run either way, kites along; its edges stand in another order."""
    arrays = variant.arrays
    for names in (("cellsOnVertex", "kiteAreasOnVertex"), ("edgesOnVertex",)):
        order = np.argsort(random.random(arrays["cellsOnVertex"].shape), axis=1)
        for name in names:
            arrays[name] = np.take_along_axis(arrays[name], order, axis=1)


def shuffle_weights(variant: Variant, random: Random) -> None:
    """The edges that reconstruct a tangent stand in any order, weights along."""
    counts = variant.arrays["nEdgesOnEdge"]
    keys = random.random(variant.arrays["edgesOnEdge"].shape)
    order = np.argsort(np.where(np.arange(keys.shape[1]) >= counts[:, None], 2.0, keys), axis=1)
    for name in ("edgesOnEdge", "weightsOnEdge"):
        variant.arrays[name] = np.take_along_axis(variant.arrays[name], order, axis=1)


def flip_normals(variant: Variant, random: Random) -> None:
    """Some normals point the other way; tangents, angles and the signs of weights go along."""
    arrays = variant.arrays
    flipped = random.random(variant.sizes["nEdges"]) < 0.3
    for name in ("cellsOnEdge", "verticesOnEdge"):
        arrays[name] = np.where(flipped[:, None], arrays[name][:, ::-1], arrays[name])
    arrays["angleEdge"] = np.where(
        flipped, (arrays["angleEdge"] + 2.0 * np.pi) % (2.0 * np.pi) - np.pi, arrays["angleEdge"]
    )
    other = np.where(arrays["edgesOnEdge"] > 0, flipped[arrays["edgesOnEdge"] - 1], False)
    arrays["weightsOnEdge"] = np.where(flipped[:, None] ^ other, -arrays["weightsOnEdge"], arrays["weightsOnEdge"])
    variant.flipped ^= flipped


def flip_tangents(variant: Variant, random: Random) -> None:
    """The vertices of some edges stand against the tangent."""
    turned = random.random(variant.sizes["nEdges"]) < 0.3
    vertices = variant.arrays["verticesOnEdge"]
    variant.arrays["verticesOnEdge"] = np.where(turned[:, None], vertices[:, ::-1], vertices)


def fill_rings(variant: Variant, random: Random) -> None:
    """What stands behind short rings is anything, and there may be more of it."""
    arrays = variant.arrays
    wider = int(random.integers(0, 4))
    variant.sizes["maxEdges"] += wider
    variant.sizes["maxEdges2"] = 2 * variant.sizes["maxEdges"]
    for count, names in (
        ("nEdgesOnCell", ("edgesOnCell", "cellsOnCell", "verticesOnCell")),
        ("nEdgesOnEdge", ("edgesOnEdge", "weightsOnEdge")),
    ):
        for name in names:
            width = variant.sizes[variant.dimensions[name][1]]
            grown = np.zeros((len(arrays[name]), width), arrays[name].dtype)
            grown[:, : arrays[name].shape[1]] = arrays[name]
            beyond = np.arange(width) >= arrays[count][:, None]
            fill = (
                random.choice([0, -1, 7, 2**31 - 1]) if name != "weightsOnEdge" else random.choice([0.0, 9.0, np.nan])
            )
            last = np.take_along_axis(grown, arrays[count][:, None].astype(int) - 1, axis=1)
            arrays[name] = np.where(beyond, last if random.random() < 0.3 else fill, grown).astype(grown.dtype)


def change_types(variant: Variant, random: Random) -> None:
    """Indices are of other types, of numbers with a point too."""
    for variable in MESH_VARIABLES:
        if variable.integer and random.random() < 0.5:
            kinds = ["f8", "f4", "i2", "i4"] + (["i8"] if variant.format in ("NETCDF4", "NETCDF3_64BIT_DATA") else [])
            values = variant.arrays[variable.file_name]
            fits = [kind for kind in kinds if np.array_equal(values.astype(kind).astype("i8"), values.astype("i8"))]
            variant.arrays[variable.file_name] = values.astype(str(random.choice(fits)))


def change_radius(variant: Variant, random: Random) -> None:
    """The sphere has another radius, which the attribute tells, or not."""
    radius = float(random.choice([2.0, 6371229.0, 0.5]))
    for variable in MESH_VARIABLES:
        power = {"m": 1, "m2": 2}.get(variable.units, 0)
        variant.arrays[variable.file_name] = variant.arrays[variable.file_name] * radius**power
    variant.attributes["sphere_radius"] = radius
    if random.random() < 0.3:
        del variant.attributes["sphere_radius"]


def change_longitudes(variant: Variant, random: Random) -> None:
    """Longitudes count from another meridian, or in degrees."""
    for place in ("Cell", "Edge", "Vertex"):
        longitude = variant.arrays[f"lon{place}"]
        if random.random() < 0.5:
            variant.arrays[f"lon{place}"] = np.where(longitude > np.pi, longitude - 2.0 * np.pi, longitude)
        else:
            for name, unit in ((f"lon{place}", "degrees_east"), (f"lat{place}", "degrees_north")):
                variant.arrays[name] = np.degrees(variant.arrays[name])
                variant.units[name] = unit


def spoil_what_is_spare(variant: Variant, random: Random) -> None:
    """Angles of edges are as bad as a well-known converter leaves them."""
    variant.arrays["angleEdge"] = variant.arrays["angleEdge"] + random.normal(size=variant.sizes["nEdges"]) * 0.02


def drop_variables(variant: Variant, random: Random) -> None:
    """Some variables are not there, three times in ten one that is needed."""
    names = [variable.file_name for variable in MESH_VARIABLES if variable.file_name not in NEEDED]
    for name in random.choice(names, int(random.integers(1, len(names))), replace=False):
        variant.arrays.pop(name, None)
    if random.random() < 0.3:
        del variant.arrays["cellsOnVertex"]


def change_format(variant: Variant, random: Random) -> None:
    """The file is of another format, its numbers perhaps of the other order of bytes."""
    variant.format = str(random.choice(FORMATS))


CHANGES: tuple[Callable[[Variant, Random], None], ...] = (
    *(rotate_rings, turn_rings, pair_vertices_before, shuffle_neighbours, shuffle_corners, shuffle_weights),
    *(flip_normals, flip_tangents, change_radius, change_longitudes, spoil_what_is_spare),
    *(fill_rings, change_format, change_types, drop_variables),
)
"""In the order in which those that are chosen are done: the last ones leave others no arrays to change."""


def _taken(rings: np.ndarray, counts: np.ndarray, place: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Rings with entry `place(j, n)` of the n before at j; what is beyond the counts stays."""
    j, n = np.broadcast_arrays(np.arange(rings.shape[1]), counts[:, None])
    return np.take_along_axis(rings, np.where(j < n, place(j, n), j), axis=1)


@functools.cache
def originals() -> tuple[VoronoiMesh, ...]:
    """A regular mesh, one with pentagons and heptagons, and one of random points, with obtuse triangles."""
    random = np.random.default_rng(5)
    return (
        scvt_mesh(162),
        scvt_mesh(120, start="random", tolerance=1e-3),
        mesh_from_points(random.normal(size=(100, 3))),
    )


def run_on(mesh: VoronoiMesh) -> tuple[np.ndarray, np.ndarray]:
    """Thickness and velocity of test case 5 after some steps."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        simulation = Simulation(mesh, Williamson5(), time_step=TIME_STEP)
        simulation.run(HOURS / 24.0, progress=False)
    return simulation.state.thickness, simulation.state.normal_velocity


@functools.cache
def run_of_original(number: int) -> tuple[np.ndarray, np.ndarray]:
    return run_on(originals()[number])


def outcome(number: int, seed: int, folder: Path) -> str:
    """What a variant ended in, WRONG at the start of what must not be; edges are compared that have the same cells."""
    random = np.random.default_rng([seed, number])
    which = int(random.integers(len(originals())))
    original, path = originals()[which], folder / f"variant{number}.nc"
    write_mesh(original, path)
    variant = Variant(path)
    chosen = [change for change in CHANGES if random.random() < 0.3] or [CHANGES[number % len(CHANGES)]]
    for change in chosen:
        change(variant, random)
    path.unlink()
    variant.write(path)
    made = f"variant {number} of seed {seed} ({', '.join(change.__name__ for change in chosen)})"
    try:
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            mesh = read_mesh(path)
    except MeshError as error:
        missing = "cellsOnVertex is missing" in str(error) and "cellsOnVertex" not in variant.arrays
        return "says what is missing" if missing else f"WRONG: {made}: {error}"
    if len(told) > 1 or any("\n" in str(warning.message) for warning in told):
        return f"WRONG: {made}: {len(told)} warnings"
    thickness, velocity = run_on(mesh)
    expected_thickness, expected_velocity = run_of_original(which)
    sign = _sign_to_original(mesh, original)
    difference = max(
        np.abs(thickness - expected_thickness).max() / expected_thickness.max(),
        np.abs(velocity * sign[1] - expected_velocity[sign[0]]).max() / np.abs(expected_velocity).max(),
    )
    if not difference <= RUN_TOLERANCE:
        return f"WRONG: {made}: the run differs by {difference:.1e}"
    return "the same run"


def _sign_to_original(mesh: VoronoiMesh, original: VoronoiMesh) -> tuple[np.ndarray, np.ndarray]:
    """The edge of the original between the same cells, and +1 where its normal points the same way, else -1."""
    known = {tuple(sorted(cells)): edge for edge, cells in enumerate(original.cells_on_edge.tolist())}
    edges = np.array([known[tuple(sorted(cells))] for cells in mesh.cells_on_edge.tolist()])
    return edges, np.where(mesh.cells_on_edge[:, 0] == original.cells_on_edge[edges, 0], 1.0, -1.0)


def outcomes(count: int, seed: int) -> Counter[str]:
    """Outcomes of so many variants."""
    with tempfile.TemporaryDirectory() as name:
        return Counter(outcome(number, seed, Path(name)) for number in range(count))


def main(count: int, seed: int) -> int:
    """Print the outcomes of `count` variants; give the number of those that ended as they must not."""
    found = outcomes(count, seed)
    for words, number in found.most_common():
        print(f"{number:4d}  {words}")
    return sum(number for words, number in found.items() if words.startswith("WRONG"))


if __name__ == "__main__":
    sys.exit(1 if main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0) else 0)
