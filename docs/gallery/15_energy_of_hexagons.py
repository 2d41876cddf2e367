r"""
Gersho's conjecture: hexagons
=============================

With many generators, centroidal Voronoi tessellations of least energy become hexagons nearly everywhere. On average, no
cell of area :math:`A` has less energy than the hexagon's :math:`\frac{5}{18 \sqrt{3}} A^2`; so the ratio of the two
says how far a mesh is from the best there is.
"""

# %%
# Regular hexagons have it to round-off.

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection

import trisk
from mesh.generation.optimizer import Limits
from mesh.plane.domain import Rectangle
from mesh.plane.generation import converge_on_plane
from mesh.plane.plane_mesh import plane_mesh
from mesh.plane.starts import starting_points

HEXAGON = 5.0 / (18.0 * np.sqrt(3.0))


def excess(energy: float, plane: Rectangle, cells: int) -> float:
    """By what part the energy is above that of as many hexagons of the same area."""
    return energy / (cells * HEXAGON * (plane.area / cells) ** 2) - 1.0


rows, columns = 36, 40
hexagons = trisk.hexagon_mesh((columns, rows * np.sqrt(0.75)), (columns, rows))
plane = Rectangle(hexagons.x_period, hexagons.y_period, "xy")
as_they_are = converge_on_plane(hexagons.cell_points, plane)
of_hexagons = excess(as_they_are.history.energy[0], plane, hexagons.n_cells)
print(f"{hexagons.n_cells} regular hexagons: ratio 1 {of_hexagons:+.1e}, {as_they_are.history.iterations} iterations")
assert abs(of_hexagons) < 1e-13
assert as_they_are.history.iterations == 0

# %%
# **Planes from random points.** On a periodic plane, what remains above one are the defects: cells of five and seven
# sides, which cost about one per cent, however many cells there are. Walls cost energy too, the less the more
# cells there are, as only some sqrt(n) of n are at walls. Rows of points, the default start, leave nearly all defects
# to the walls, and the ratio tends to one.

counts = (64, 256, 1024, 4096)
kinds = {
    "periodic, random": ("xy", "random"),
    "box, random": ("none", "random"),
    "box, rows": ("none", "rows"),
}
above, points = {}, {}
print("cells " + "".join(f"{kind:>20}" for kind in kinds))
for count in counts:
    for kind, (periodic, start) in kinds.items():
        square = Rectangle(1.0, 1.0, periodic)
        begin = starting_points(square, count, start=start, seed=1)
        result = converge_on_plane(begin, square, limits=Limits(1e-6))
        assert result.reason == "tolerance"
        above[kind, count] = excess(result.history.energy[-1], square, count)
        points[kind, count] = result.points
    print(f"{count:5} " + "".join(f"{1.0 + above[kind, count]:20.5f}" for kind in kinds))
assert min(above.values()) > 0.0
assert above["box, random", 4096] < 0.5 * above["box, random", 64]
assert (np.diff([above["box, rows", count] for count in counts]) < 0.0).all()

slope = np.polyfit(np.log(counts), np.log([above["box, rows", count] for count in counts]), 1)[0]
print(f"from rows, the ratio less one falls as n to the power {slope:.2f}, that of walls is -0.5")
assert abs(slope + 0.5) < 0.1

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
for kind in kinds:
    axes.loglog(counts, [above[kind, count] for count in counts], "o-", label=kind)
axes.set(xlabel="cells", ylabel="energy over that of hexagons, less one")
axes.legend()

# %%
# The sides of 1024 cells: from random points defects are everywhere, from rows nearly all of them are at the walls.


def draw(axes: Axes, kind: str) -> None:
    """Cells by their sides; those that a seam divides are left out."""
    mesh = plane_mesh(points[kind, 1024], Rectangle(1.0, 1.0, kinds[kind][0]))
    rings = zip(mesh.vertices_on_cell, mesh.n_edges_on_cell, strict=True)
    polygons = [mesh.vertex_points[ring[:sides], :2] for ring, sides in rings]
    whole = [np.ptp(polygon, axis=0).max() < 0.5 for polygon in polygons]
    sides = mesh.n_edges_on_cell[whole].astype(float)
    shown = [polygon for polygon, kept in zip(polygons, whole, strict=True) if kept]
    cells = PolyCollection(shown, array=sides, cmap="RdYlBu", clim=(3.5, 8.5), edgecolors="white", linewidths=0.4)
    axes.add_collection(cells)
    axes.set(title=kind, xlabel="x", ylabel="y", xlim=(0, 1), ylim=(0, 1), aspect="equal")
    figure.colorbar(cells, ax=axes, label="sides", shrink=0.8)


figure, panels = plt.subplots(1, 3, figsize=(15, 4.6), layout="constrained")
for panel, kind in zip(panels, kinds, strict=True):
    draw(panel, kind)
