"""
Voronoi cells and Delaunay triangles of a square
================================================

Thirty random generators in the unit square, their Voronoi cells and the triangles dual to them, with what makes them
so checked: bisection, empty circles, and a square that is covered once. Stands beside the first figures of Ju, Ringler
and Gunzburger (2011), *Voronoi tessellations and their application to climate and global modeling*.
"""

# %%
# Walls clip the cells: each is a straight bisector between a generator and its mirror image.

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.path import Path
from scipy.spatial import Delaunay, cKDTree

import trisk
from mesh.plane.domain import Rectangle
from mesh.plane.plane_mesh import plane_mesh

random = np.random.default_rng(3)
generators = random.random((30, 2))
mesh = plane_mesh(np.column_stack([generators, np.zeros(30)]), Rectangle(1.0, 1.0, "none"))
corners = mesh.vertex_points[:, :2]
polygons = [corners[ring[:sides]] for ring, sides in zip(mesh.vertices_on_cell, mesh.n_edges_on_cell, strict=True)]
print(f"{mesh.n_cells} cells, {mesh.n_edges} edges, {mesh.n_vertices} corners")


def draw(axes: Axes, title: str) -> None:
    """Cells and generators, and the square with equal axes."""
    axes.add_collection(PolyCollection(polygons, facecolors="none", edgecolors="tab:blue"))
    axes.plot(*generators.T, "k.")
    axes.set(title=title, xlabel="x", ylabel="y", xlim=(-0.02, 1.02), ylim=(-0.02, 1.02), aspect="equal")


# %%
# **Bisection.** Both ends of every edge inside are as far from one of its generators as from the other, so the edge
# lies on their perpendicular bisector; and no other generator is nearer.

inside = mesh.cells_on_edge[:, 1] >= 0
ends = corners[mesh.vertices_on_edge[inside]]
pair = generators[mesh.cells_on_edge[inside]]
distances = np.linalg.norm(ends[:, :, None] - pair[:, None], axis=3)
bisection = np.abs(distances[:, :, 0] - distances[:, :, 1]).max()
nearest = cKDTree(generators).query(ends)[0]
print(f"{inside.sum()} edges: the distances from their ends to the two generators differ by at most {bisection:.1e}")
print(f"the nearest generator is nearer by at most {(distances[:, :, 0] - nearest).max():.1e}")
assert bisection < 1e-12
assert (distances[:, :, 0] - nearest).max() < 1e-12

# %%
# **The square is covered once.** The areas of the cells sum to one, and each of many random points lies in one cell
# only: that of its nearest generator.

samples = random.random((20_000, 2))
within = np.array([Path(polygon).contains_points(samples) for polygon in polygons])
owner = cKDTree(generators).query(samples)[1]
print(f"area of all cells: 1 {mesh.area_cell.sum() - 1.0:+.1e}")
print(f"of {len(samples)} points {(within.sum(axis=0) == 1).sum()} lie in one cell")
assert abs(mesh.area_cell.sum() - 1.0) < 1e-13
assert (within.sum(axis=0) == 1).all()
assert (within.argmax(axis=0) == owner).all()

# %%
# **Duality and empty circles.** Where three cells meet is the centre of a circle through their generators, with no
# generator within: their triangle is a Delaunay triangle. Those that scipy finds are the same, and some more along the
# hull: their centres lie beyond the walls, where no cell reaches.

triangles = mesh.cells_on_vertex[(mesh.cells_on_vertex >= 0).all(axis=1)]
every = Delaunay(generators).simplices


def circles(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centres (n, 2) and radii (n,) of the circles through the corners of triangles."""
    first, second, third = (generators[triangles[:, k]] for k in range(3))
    sides = np.stack([second - first, third - first], axis=1)
    centres = first + np.linalg.solve(sides, 0.5 * (sides**2).sum(axis=2)[..., None])[..., 0]
    return centres, np.linalg.norm(centres - first, axis=1)


centres, radii = circles(every)
emptiness = cKDTree(generators).query(centres)[0] - radii
beyond = ((centres < 0.0) | (centres > 1.0)).any(axis=1)
ours = {tuple(sorted(triangle)) for triangle in triangles.tolist()}
theirs = {tuple(sorted(triangle)) for triangle in every[~beyond].tolist()}
print(f"{len(every)} Delaunay triangles, {beyond.sum()} of them with centres beyond the walls")
print(f"no generator is within a circle by more than {max(0.0, -emptiness.min()):.1e}")
assert ours == theirs
assert emptiness.min() > -1e-12

# %%
# The corners of the cells are the centres of these circles. And the mesh passes the checks of all meshes.

gaps = cKDTree(corners).query(centres[~beyond])[0]
print(f"centres of circles and corners of cells differ by at most {gaps.max():.1e}")
assert gaps.max() < 1e-12
defects = trisk.validate_mesh(mesh)
print(f"largest defect of {len(defects)} identities: {max(defects.values()):.1e}")

figure, (cells, dual, circled) = plt.subplots(1, 3, figsize=(13, 4.6), layout="constrained")
draw(cells, "Voronoi cells")
draw(dual, "and Delaunay triangles")
dual.triplot(*generators.T, every, color="tab:orange", linewidth=1.0)
draw(circled, "and their empty circles")
for centre, radius in zip(centres[~beyond], radii[~beyond], strict=True):
    circled.add_patch(plt.Circle(centre, radius, fill=False, color="tab:green", linewidth=0.6))
