"""Closed basins, for docs/verification.md and docs/coasts.md: python docs/tools/basins_page.py [MOST_CELLS].

Gyres of Stommel and Munk beside their solutions, the frequency of the seiche, and the speed of the Kelvin wave along
coasts that make different angles with the rows of cells; first on staircases, then on cells that the coast clips.
Meshes of the whole sphere with up to MOST_CELLS cells, 163842 where not given, are cut, and as many cells fill basins.
"""

import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import cast

import numpy as np

from cases import KelvinWave, Munk, Seiche, Stommel
from cases.basins import Basin, Wave
from cases.gyres import Gyre
from mesh import VoronoiMesh, mesh_from_points, scvt_mesh
from mesh.arrays import Array
from mesh.coast.coastline import Coastline
from mesh.coast.generation import converge_at_sea, region_mesh
from mesh.coast.sea_mesh import sea_mesh
from mesh.generation.optimizer import Limits
from mesh.geometry.sphere import fibonacci_points, from_lonlat
from mesh.mesh_request import MeshRequest
from mesh.parts.cutting import without_cells
from mesh.regions.find import find_region
from postprocess.compare.norms import scalar_norms
from swe import Simulation
from swe.constants import SECONDS_PER_DAY

LATTICES = {0: (1, 0, 240), 15: (11, 4, 18), 30: (1, 1, 139)}
"""Coasts by their angle to the rows of cells, degrees: steps along both axes of the lattice that lead from a cell to
the next one at the same distance from the coast, and how often these fit round the equator."""

NORTHERN_COAST = 0.6
"""Mercator's y of the northern coast of the channel of the Kelvin wave, radians."""

GYRE_DAYS = {"stommel": 12.0, "munk": 8.0}
"""Days after which the error stays the same."""

COAST_POINTS = 4037
"""Of each coast of the filled channel: a prime, so that no side of a cell meets the coast in one of its points."""

PERIODS = 3.0
"""Of the seiche, over which its frequency is taken."""


def basin_of(mesh: VoronoiMesh, case: Basin) -> VoronoiMesh:
    """The part of a mesh of the whole sphere that a case asks for."""
    return without_cells(mesh, case.is_outside(mesh.lon_cell, mesh.lat_cell))


def tilted(mesh: VoronoiMesh, angle: float) -> VoronoiMesh:
    """`mesh` turned by `angle`, radians, about all three axes one after another, so that no coast is along its rows."""
    points = mesh.cell_points
    for axis in range(3):
        along = np.roll(points, -axis, axis=1)
        c, s = math.cos(angle), math.sin(angle)
        along = along @ np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])
        points = np.roll(along, axis, axis=1)
    return mesh_from_points(points)


def channel(angle: int, refinement: float = 1.0) -> VoronoiMesh:
    """A channel round the sphere from the equator to `NORTHERN_COAST`, of hexagons in Mercator's map, by `LATTICES`.

    Half a row of cells, seen along the coast, stands on either side of the equator on the average.
    """
    first, second, repeats = LATTICES[angle]
    step = complex(first + 0.5 * second, second * math.sqrt(0.75))
    repeats = round(repeats * refinement)
    width = 2.0 * math.pi / (repeats * abs(step))
    reach = round(2.0 * math.pi / width) + 5
    i, j = np.meshgrid(np.arange(-reach, 2 * reach), np.arange(-2 * reach, 2 * reach))
    places = width * (i + 0.5 * j + 1j * math.sqrt(0.75) * j).ravel() / (step / abs(step))
    # Rows along the coast are this far apart.
    rows = width * math.sqrt(0.75) / abs(step)
    x, y = places.real, places.imag + 0.5 * rows
    kept = (x > -1e-9) & (x < 2.0 * math.pi - 1e-9) & (y > -4.0 * width) & (y < NORTHERN_COAST + 4.0 * width)
    x, y = x[kept], y[kept]
    rest = fibonacci_points(1000)
    beyond = np.arctanh(np.clip(rest[:, 2], -0.999, 0.999))
    rest = rest[(beyond < -0.1 - 4.0 * width) | (beyond > NORTHERN_COAST + 0.1 + 4.0 * width)]
    mesh = mesh_from_points(np.vstack([from_lonlat(x, np.arcsin(np.tanh(y))), rest]))
    at = np.arctanh(np.clip(np.sin(mesh.lat_cell), -0.999, 0.999))
    return without_cells(mesh, (at < 0.0) | (at > NORTHERN_COAST))


def filled(case: Basin, cells: int) -> VoronoiMesh:
    """The basin of a gyre or a seiche, filled up to its coast with `cells` cells."""
    return region_mesh(
        find_region("-180,180,0,90" if isinstance(case, Wave) else "0,60,10,50"), MeshRequest(cells=cells)
    )


def filled_channel(angle: int, refinement: float = 1.0) -> VoronoiMesh:
    """The basin of `channel` filled up to both coasts, from its cells, which keep their rows away from the coasts."""
    north = math.asin(math.tanh(NORTHERN_COAST))
    east = 2.0 * math.pi * np.arange(COAST_POINTS) / COAST_POINTS + 1e-4
    coast = Coastline([from_lonlat(east, np.zeros(COAST_POINTS)), from_lonlat(-east, np.full(COAST_POINTS, north))])
    cells = channel(angle, refinement)
    ashore = 0.1 * math.sqrt(coast.area / cells.n_cells)
    points = from_lonlat(cells.lon_cell, np.clip(cells.lat_cell, ashore, north - ashore))
    found = converge_at_sea(coast, points, density=as_in_the_map, limits=Limits(tolerance=1e-4))
    return sea_mesh(found.sea, found.result.points, as_in_the_map)


def as_in_the_map(points: Array) -> Array:
    """The density of cells that are equal in Mercator's map, to 45 degrees of latitude."""
    return np.maximum(1.0 - points[:, 2] ** 2, 0.5) ** -2.0


def gyre_error(mesh: VoronoiMesh, case: Gyre, days: float) -> float:
    """Relative l2 norm of the error of the height of the surface, `days` after the start from the exact solution."""
    simulation = Simulation(mesh, case)
    simulation.run(days=days, progress=False)
    exact = case.thickness(mesh.lon_cell, mesh.lat_cell)
    return scalar_norms(simulation.state.thickness - case.depth, exact - case.depth, mesh.area_cell).l2


def cells_across(mesh: VoronoiMesh, case: Gyre) -> float:
    """Distances of cells in the western boundary layer, at the middle latitude."""
    latitude = 0.5 * (case.south + case.north)
    if isinstance(case, Stommel):
        width = case.drag_rate / (2.0 * case.rotation_rate) * math.cos(latitude)
    else:
        beta = 2.0 * case.rotation_rate * math.cos(latitude) / case.radius
        width = (cast(Munk, case).viscosity / beta) ** (1.0 / 3.0) / case.radius
    return width / float(np.sqrt(2.0 / math.sqrt(3.0) * mesh.area_cell.mean()))


@dataclass(frozen=True, eq=False)
class Track:
    """How much of the shape of a wave there is in the height of the surface, at times (n,), s."""

    times: Array
    values: Array


def followed(mesh: VoronoiMesh, case: Wave, shape: Array, seconds: float, rows: int) -> Track:
    """A run of a wave on a mesh of its basin, seen through the `shape` (n_cells,), real or complex."""
    simulation = Simulation(mesh, case)
    weights = mesh.area_cell * np.conj(shape)
    rest = case.depth - case.topography(mesh.lon_cell, mesh.lat_cell)
    times, values = [], []
    for row in range(rows + 1):
        if row > 0:
            simulation.run(until=row * seconds / rows / SECONDS_PER_DAY, progress=False)
        times.append(simulation.time)
        values.append(weights @ (simulation.state.thickness - rest) / (weights @ shape).real)
    return Track(np.array(times), np.array(values))


def seiche_error(mesh: VoronoiMesh, case: Seiche) -> float:
    """Relative error of the frequency of a seiche on a mesh of its basin: from the last time that it is level."""
    seconds = PERIODS * 2.0 * math.pi / case.frequency
    track = followed(mesh, case, case.highest(mesh.lon_cell, mesh.lat_cell), seconds, 150)
    before = np.flatnonzero(track.values[1:] * track.values[:-1] < 0.0)
    last = before[-1]
    part = track.values[last] / (track.values[last] - track.values[last + 1])
    level = track.times[last] + part * (track.times[last + 1] - track.times[last])
    return math.pi * (len(before) - 0.5) / level / case.frequency - 1.0


def kelvin_error(mesh: VoronoiMesh, case: KelvinWave, days: float = 5.0) -> tuple[float, float]:
    """Relative error of the speed of a Kelvin wave on a mesh of its basin, and the part of its height that is left."""
    rate = case.wave_number * case.speed / case.radius
    everywhere = np.zeros(mesh.n_cells)
    rest = case.depth - case.topography(everywhere, mesh.lat_cell)
    height = case.thickness(everywhere, mesh.lat_cell) - rest
    shape = height * np.exp(1j * case.wave_number * mesh.lon_cell)
    track = followed(mesh, case, shape, days * SECONDS_PER_DAY, 40)
    phase = -np.unwrap(np.angle(track.values))
    return phase[-1] / (rate * track.times[-1]) - 1.0, float(np.abs(track.values[-1] / track.values[0]))


def gyre_lines(meshes: dict[Gyre, dict[int, VoronoiMesh]]) -> Iterator[str]:
    """Errors of gyres on meshes by their number of cells, and their orders from mesh to mesh."""
    yield "| case | cells of the mesh | of the sea | cells across the layer | l2(height of the surface) | order |"
    yield "|---|---|---|---|---|---|"
    for case, basins in meshes.items():
        last: tuple[float, float] | None = None
        for cells, mesh in basins.items():
            across, error = cells_across(mesh, case), gyre_error(mesh, case, GYRE_DAYS[case.name])
            order = "" if last is None else f"{math.log(last[1] / error) / math.log(across / last[0]):.2f}"
            yield f"| `{case.name}` | {cells} | {mesh.n_cells} | {across:.1f} | {error:.4f} | {order} |"
            last = across, error


def seiche_lines(basins: dict[int, VoronoiMesh]) -> Iterator[str]:
    """Errors of the frequency of two seiches on meshes by their number of cells."""
    yield "| cells of the mesh | of the sea | frequency, degree 2 order 0 (%) | degree 1 order 1 (%) |"
    yield "|---|---|---|---|"
    for cells, mesh in basins.items():
        errors = [seiche_error(mesh, Seiche(degree=degree, order=order)) for degree, order in ((2, 0), (1, 1))]
        yield f"| {cells} | {mesh.n_cells} | " + " | ".join(f"{100.0 * error:+.3f}" for error in errors) + " |"


def kelvin_lines(refinements: tuple[float, ...], basin: Callable[[int, float], VoronoiMesh]) -> Iterator[str]:
    """Errors of the speed of the Kelvin wave by angle and spacing, in `basin` by both."""
    yield "| cells across c/f | coast at 0 degrees (%) | 15 degrees (%) | 30 degrees (%) |"
    yield "|---|---|---|---|"
    case = KelvinWave()
    radius_of_deformation = case.speed / (2.0 * case.rotation_rate * case.radius)
    for refinement in refinements:
        errors = [kelvin_error(basin(angle, refinement), case) for angle in LATTICES]
        across = radius_of_deformation * 240 * refinement / (2.0 * math.pi)
        shown = " | ".join(f"{100.0 * error:+.2f} (height {left:.4f})" for error, left in errors)
        yield f"| {across:.1f} | {shown} |"


def main() -> None:
    """Print the tables."""
    most = int(sys.argv[1]) if sys.argv[1:] else 163842
    whole = {cells: scvt_mesh(cells) for cells in (2562, 10242, 40962, 163842) if cells <= most}
    gyres = (Stommel(), Munk())
    cut = {case: {n: basin_of(mesh, case) for n, mesh in whole.items() if n > 2562} for case in gyres}
    turned = {n: basin_of(tilted(mesh, 0.7), Seiche()) for n, mesh in whole.items() if n <= 10242}
    boxes = {n: filled(Stommel(), n) for n in (390, 1560, 6240) if n <= most}
    hemispheres = {n: filled(Seiche(), n) for n in (1281, 2562, 5121) if n <= most}
    refinements = (0.5, 1.0, 2.0)
    tables = (
        *(gyre_lines(cut), seiche_lines(turned), kelvin_lines(refinements, channel)),
        *(gyre_lines(dict.fromkeys(gyres, boxes)), seiche_lines(hemispheres)),
        kelvin_lines(refinements, filled_channel),
    )
    for lines in tables:
        for line in lines:
            print(line, flush=True)
        print()


if __name__ == "__main__":
    main()
