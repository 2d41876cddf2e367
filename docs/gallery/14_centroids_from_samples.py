"""
Centroids from samples
======================

Where integrals over Voronoi cells are out of reach, samples of the density tell where centroids are: the
probabilistic version of Lloyd's method, Algorithm 2 of Ju, Ringler and Gunzburger (2011), in the unit square, with its
error measured.
"""

# %%
# **Rejection sampling** draws from a density: points are drawn evenly, and each is kept with a probability that is the
# density there over its largest value.

from collections.abc import Callable

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from scipy.spatial import cKDTree

import trisk
from mesh.integrals.plane_centroids import plane_centroids
from mesh.plane.domain import Rectangle
from mesh.plane.generation import converge_on_plane
from mesh.plane.plane_mesh import plane_mesh
from mesh.plane.starts import starting_points

Density = Callable[[np.ndarray], np.ndarray]

square = Rectangle(1.0, 1.0, "none")
random = np.random.default_rng(11)


def peak(points: np.ndarray) -> np.ndarray:
    """Density at points (n, 2 or 3): one at the centre of the square, a twentieth far from it."""
    return 0.05 + 0.95 * np.exp(-20.0 * ((points[:, :2] - 0.5) ** 2).sum(axis=1))


def even(points: np.ndarray) -> np.ndarray:
    """Density one at points (n, 2 or 3)."""
    return np.ones(len(points))


def sampled(density: Density, count: int) -> np.ndarray:
    """So many points (count, 2) from a density that is at most one."""
    kept = np.empty((0, 2))
    while len(kept) < count:
        tried = random.random((count, 2))
        kept = np.concatenate([kept, tried[random.random(count) < density(tried)]])
    return kept[:count]


# %%
# Shares of samples in 16 by 16 boxes come near those of the density as one over the root of their number.

SIDE = 16
fine = (np.arange(SIDE * 16) + 0.5) / (SIDE * 16)
grid = np.stack(np.meshgrid(fine, fine, indexing="ij"), axis=-1).reshape(-1, 2)
exact = np.histogram2d(*grid.T, bins=SIDE, range=[(0, 1), (0, 1)], weights=peak(grid))[0]
exact /= exact.sum()
numbers = 4 ** np.arange(5, 10)
misses = []
for number in numbers:
    shares = np.histogram2d(*sampled(peak, number).T, bins=SIDE, range=[(0, 1), (0, 1)])[0] / number
    misses.append(np.sqrt(((shares - exact) ** 2).sum()))
    expected = np.sqrt((exact * (1.0 - exact)).sum() / number)
    print(f"{number:7} samples: shares miss by {misses[-1]:.5f}, expected {expected:.5f}")
    assert 0.8 < misses[-1] / expected < 1.2
slope = np.polyfit(np.log(numbers), np.log(misses), 1)[0]
print(f"slope {slope:.3f}, expected -0.5")
assert abs(slope + 0.5) < 0.05

# %%
# **Algorithm 2.** Each iteration takes :math:`q` samples and gives each to its nearest generator. A generator :math:`x`
# whose samples have the mean :math:`u` moves to
#
# .. math:: \frac{(\alpha_1 j + \beta_1) x + (\alpha_2 j + \beta_2) u}{j + 1},
#
# where :math:`j` counts its moves, :math:`\alpha_1 + \alpha_2 = 1` and :math:`\beta_1 + \beta_2 = 1`.


def moved(
    points: np.ndarray, density: Density, samples: int, iterations: int, alpha: float = 1.0, beta: float = 1.0
) -> np.ndarray:
    """Generators (n, 2) after iterations with so many samples each; `alpha` and `beta` are alpha_2 and beta_2."""
    points, moves = points.copy(), np.ones(len(points))
    for _ in range(iterations):
        drawn = sampled(density, samples)
        nearest = cKDTree(points).query(drawn)[1]
        counts = np.bincount(nearest, minlength=len(points))
        sums = np.stack([np.bincount(nearest, axis, minlength=len(points)) for axis in drawn.T], axis=1)
        hit = counts > 0
        share = ((alpha * moves[hit] + beta) / (moves[hit] + 1.0))[:, None]
        points[hit] = (1.0 - share) * points[hit] + share * sums[hit] / counts[hit, None]
        moves[hit] += 1.0
    return points


# %%
# **The error against q and n.** With :math:`\alpha_2 = \beta_2 = 1` each iteration is one of Lloyd's with sampled
# centroids. The start is converged, so that all that moves the generators is the error of the samples. A cell gets
# :math:`q / n` of them, and in a hexagon the root mean square distance of their mean from the centroid is
# :math:`\frac{\sqrt{5}}{6} \sqrt{n / q}` distances of neighbours. In other cells its square is their energy over
# their area and the number of samples, which has the mean :math:`n / q + (n / q)^2` of its inverse nearly.
# Where generators stand after ten iterations, they are off the centroids of their cells, which are known exactly, by
# somewhat less.

counts, per_cell = (64, 256, 1024), (16, 64, 256)
print("    n        q   sampled centroid   generator after ten iterations   (rms, mean distances)")
table = []
for n in counts:
    converged = converge_on_plane(starting_points(square, n, start="random", seed=2), square)
    fixed = square.folded(converged.points)[:, :2]
    for ratio in per_cell:
        once = np.linalg.norm(moved(fixed, even, ratio * n, 1) - fixed, axis=1)
        later = plane_mesh(np.column_stack([moved(fixed, even, ratio * n, 10), np.zeros(n)]), square)
        off = np.linalg.norm(plane_centroids(later) - later.cell_points, axis=1)
        expected = np.sqrt(converged.history.energy[-1] * (1.0 / ratio + 1.0 / ratio**2))
        row = [each / square.spacing(n) for each in (*(np.sqrt((way**2).mean()) for way in (once, off)), expected)]
        table.append((n, ratio * n, *row))
        print(f"{n:5} {ratio * n:8} {row[0]:18.5f} {row[1]:32.5f}")

n, q, once, later, expected = np.array(table).T
slopes = [np.polyfit(np.log(n / q), np.log(error), 1)[0] for error in (once, later)]
constant, agreement = (np.exp(np.log(once / other).mean()) for other in (np.sqrt(n / q), expected))
print(f"slopes against n / q: {slopes[0]:.3f} and {slopes[1]:.3f}, expected 0.5")
print(f"error of a sampled centroid: {constant:.3f} sqrt(n / q), {np.sqrt(5.0) / 6.0:.3f} of hexagons")
assert abs(np.array(slopes) - 0.5).max() < 0.05
print(f"that is {agreement:.3f} times what the energy of these cells says")
assert abs(agreement - 1.0) < 0.05

figure, axes = plt.subplots(figsize=(6, 4.2), layout="constrained")
for count, marker in zip(counts, "os^", strict=True):
    rows = n == count
    axes.loglog((n / q)[rows], once[rows], marker, color="tab:blue", label=f"sampled centroids, n = {count}")
    axes.loglog((n / q)[rows], later[rows], marker, color="tab:orange", label=f"after ten iterations, n = {count}")
line = np.array([1.0 / 256, 1.0 / 16])
axes.loglog(line, np.sqrt(5.0) / 6.0 * np.sqrt(line), "k", linewidth=0.8, label="sqrt(5) / 6 sqrt(n / q)")
axes.set(xlabel="n / q", ylabel="error (mean distances)")
axes.minorticks_off()
axes.set_xticks([1 / 256, 1 / 64, 1 / 16], ["1/256", "1/64", "1/16"])
axes.set_yticks([0.02, 0.05, 0.1], ["0.02", "0.05", "0.1"])
axes.legend(fontsize=8)

# %%
# Under the density, from a start drawn from it, each step goes half way to the mean of the samples. In a centroidal
# Voronoi tessellation of many cells, widths are as the density to the power -1/4; the start has -1/2, which Lloyd's
# steps, sampled or not, forget slowly. Beside it, the mesh that the L-BFGS method makes from the same start, with
# integrals in the place of samples.

CELLS = 256
first = starting_points(square, CELLS, peak, "random", seed=3)
by_samples = plane_mesh(
    np.column_stack([moved(first[:, :2], peak, 100 * CELLS, 60, 0.5, 0.5), np.zeros(CELLS)]), square, peak
)
by_integrals = trisk.mesh_on_plane(
    trisk.MeshRequest(cells=CELLS, plane=(1.0, 1.0), periodic="none", density=peak, start="random", seed=3)
)

figure, axes = plt.subplots(1, 2, figsize=(11, 4.8), layout="constrained")
for each, mesh, title in zip(axes, (by_samples, by_integrals), ("Algorithm 2, 60 iterations", "L-BFGS"), strict=True):
    rings = zip(mesh.vertices_on_cell, mesh.n_edges_on_cell, strict=True)
    polygons = [mesh.vertex_points[ring[:sides], :2] for ring, sides in rings]
    widths = np.sqrt(mesh.area_cell)
    cells = PolyCollection(polygons, array=widths, clim=(0.03, 0.11), edgecolors="white", linewidths=0.4)
    each.add_collection(cells)
    figure.colorbar(cells, ax=each, label="width of the cells")
    each.set(title=title, xlabel="x", ylabel="y", xlim=(0, 1), ylim=(0, 1), aspect="equal")
    power = np.polyfit(np.log(mesh.mesh_density), np.log(widths), 1)[0]
    print(f"{title}: widths as the density to the power {power:.3f}")
assert abs(power + 0.25) < 0.01  # of the last one, L-BFGS
