"""Fig. 10 of Ju, Ringler and Gunzburger (2011), the North Atlantic: python docs/tools/north_atlantic.py FOLDER [CELLS].

A coarse run of the double gyre gives the mean kinetic energy, that and the distance to the coast the density, and the
coast clips the cells. Writes meshes and pictures, and prints a table. What the folder holds is not made again.
"""

import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from cases.gyres import DoubleGyre
from mesh import MeshRequest, VoronoiMesh, find_region, mesh_quality, read_mesh, region_mesh, write_mesh
from mesh.arrays import Array
from mesh.coast.generation import Shore
from mesh.discrete.walls import wall_edges
from mesh.geometry.sphere import hexagon_spacing
from postprocess import open_run
from postprocess.adaptation.energy_density import asked_spacing, request_for, write_energy
from postprocess.figures.field_map import plot_field
from swe import Simulation
from swe.constants import EARTH_RADIUS, SECONDS_PER_DAY

REGION = "north-atlantic"
CELLS = (47305, 183907)
COARSE_CELLS, COARSE_DAYS, SNAPSHOT_DAYS = 5000, 720.0, 20.0
COAST_WIDTH, COAST_FACTOR = 100.0, 12.0
"""Width, km, over which the density rises towards the coast, and how many times at the coast."""

FLOOR = 0.2
"""The least kinetic energy, over the largest: spacings vary by its inverse, and by the fourth root of the factor."""

TOLERANCE = 1e-3
FAR = 3.0
"""Spacings from the coast at which cells do not feel it."""

CENTRE, EXTENT = (-46.0, 32.0), (100.0, 70.0)
ZOOMS = (("Florida and the Bahamas", (-79.0, 27.5), 8.0), ("British Isles", (-4.0, 55.0), 16.0))
TICKS = (1, 2, 3, 5, 7, 10, 15, 20, 30, 40, 60)
HEADER = (
    "| cells | processor minutes | spacing (km) | ratio | q_avg | shortest inner edge | shortest at the coast "
    "| off the law |\n"
    "|---|---|---|---|---|---|---|---|"
)


def energy_of_coarse_run(folder: Path) -> Path:
    """The file of the mean kinetic energy of a run on uniform cells."""
    path, run = folder / "energy.nc", folder / "coarse"
    if not path.exists():
        mesh = region_mesh(find_region(REGION), MeshRequest(COARSE_CELLS))
        Simulation(mesh, DoubleGyre(), run, snapshot_interval=SNAPSHOT_DAYS * SECONDS_PER_DAY, overwrite=True).run(
            COARSE_DAYS
        )
        write_energy(open_run(run), path)
    return path


def mesh_for(cells: int, energy: Path, folder: Path) -> tuple[VoronoiMesh, float | None]:
    """The mesh of so many cells, and the minutes of processor time that it took, None where it was there."""
    path = folder / f"mesh-{cells}.nc"
    if path.exists():
        return read_mesh(path), None
    begin = time.process_time()
    shore = Shore(COAST_WIDTH * 1000.0 / EARTH_RADIUS, COAST_FACTOR)
    request = replace(request_for(cells, energy, TOLERANCE), density_floor=FLOOR)
    mesh = region_mesh(find_region(REGION), request, shore=shore)
    minutes = (time.process_time() - begin) / 60.0
    write_mesh(mesh, path, "the North Atlantic for the kinetic energy of a double gyre")
    return mesh, minutes


def spacing_of(mesh: VoronoiMesh) -> Array:
    """Spacing of each cell (n_cells,), km: that of a hexagon of its area."""
    return hexagon_spacing(mesh.area_cell) * EARTH_RADIUS / 1000.0


def row_of(mesh: VoronoiMesh, minutes: float | None) -> str:
    """A row of the table; edges are measured in spacings of their cells."""
    spacing, walls = spacing_of(mesh), wall_edges(mesh)
    local = spacing / (EARTH_RADIUS / 1000.0)
    inner = np.setdiff1d(np.arange(mesh.n_edges), walls)
    short = mesh.dv_edge[inner] / local[mesh.cells_on_edge[inner]].mean(axis=1)
    short_at_coast = mesh.dv_edge[walls] / local[mesh.cells_on_edge[walls].max(axis=1)]
    asked = asked_spacing(mesh.mesh_density, mesh.area_cell)
    far = find_region(REGION).distance(mesh.cell_points) > FAR * local
    # The constant of the law is that of the cells away from coasts.
    relative = (local / asked)[far] / np.mean((local / asked)[far])
    took = "there" if minutes is None else f"{minutes:.1f}"
    least, most = spacing.min(), spacing.max()
    return (
        f"| {mesh.n_cells} | {took} | {least:.1f} to {most:.1f} | {most / least:.1f} | "
        f"{mesh_quality(mesh).q_avg:.4f} | {short.min():.3f} | {short_at_coast.min():.3f} | "
        f"{np.abs(relative - 1.0).mean():.3f} |"
    )


def picture(mesh: VoronoiMesh) -> Figure:
    """Spacing over the whole sea, and two places from near, with their cells."""
    spacing = spacing_of(mesh)
    figure = Figure(figsize=(14.0, 8.0), layout="constrained")
    places = figure.subplot_mosaic([["whole", "first"], ["whole", "second"]], width_ratios=[1.6, 1.0])
    whole, *near = places.values()
    norm = LogNorm(spacing.min(), spacing.max())
    _map(mesh, spacing, whole, norm, CENTRE, EXTENT, f"North Atlantic, {mesh.n_cells} cells")
    for axes, (name, centre, extent) in zip(near, ZOOMS, strict=True):
        _map(mesh, spacing, axes, norm, centre, (extent, 0.75 * extent), name)
        axes.collections[-1].set(edgecolor="black", linewidth=0.2)
    drawn = whole.collections[-1]
    bar = figure.colorbar(drawn, ax=whole, location="bottom", shrink=0.8, label="spacing (km)")
    bar.set_ticks([tick for tick in TICKS if spacing.min() <= tick <= spacing.max()])
    bar.ax.xaxis.set_major_formatter("{x:g}")
    bar.ax.xaxis.set_minor_formatter("")
    return figure


def _map(
    mesh: VoronoiMesh,
    spacing: Array,
    axes: Axes,
    norm: LogNorm,
    centre: tuple[float, float],
    extent: tuple[float, float],
    title: str,
) -> None:
    plot_field(mesh, spacing, axes, centre=centre, extent=extent, norm=norm, colour_bar=False)
    axes.set_title(title)


def main(folder: Path, sizes: Sequence[int]) -> None:
    """Make meshes of these numbers of cells, and tell and draw what they are like."""
    folder.mkdir(parents=True, exist_ok=True)
    energy = energy_of_coarse_run(folder)
    print(HEADER)
    for cells in sizes:
        mesh, minutes = mesh_for(cells, energy, folder)
        print(row_of(mesh, minutes), flush=True)
        picture(mesh).savefig(folder / f"mesh-{cells}.png", dpi=90)


if __name__ == "__main__":
    main(Path(sys.argv[1]), [int(cells) for cells in sys.argv[2:]] or CELLS)
