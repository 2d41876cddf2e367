"""
From any triangulation to Delaunay's by flips
=============================================

Two triangles side by side form a quadrilateral with two diagonals. Lawson's flips take the other diagonal wherever a
circle through three corners holds the fourth, and end with the Delaunay triangulation, from wherever they start.
"""

# %%
# The start is as poor as can be: points are taken from west to east, and each is joined to all that it sees. Four
# of them are the corners of the square, so that no sliver stays at the hull, whose sides cannot be flipped.

from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
from scipy.spatial import Delaunay, cKDTree

import trisk
from mesh.plane.domain import Rectangle
from mesh.plane.moving import PlaneCells
from mesh.plane.plane_mesh import plane_mesh
from mesh.plane.starts import starting_points

Triangle = tuple[int, int, int]

random = np.random.default_rng(5)
points = np.concatenate([random.uniform(0.06, 0.94, (36, 2)), [(0, 0), (1, 0), (0, 1), (1, 1)]])
points = points[np.argsort(points[:, 0])]


def turn(a: int, b: int, c: int) -> float:
    """Twice the area of a triangle, positive if counter-clockwise."""
    (ux, uy), (vx, vy) = points[b] - points[a], points[c] - points[a]
    return float(ux * vy - uy * vx)


def swept() -> list[Triangle]:
    """Counter-clockwise triangles of each point with the sides of the hull, west of it, that it sees."""
    first = (0, 1, 2) if turn(0, 1, 2) > 0.0 else (0, 2, 1)
    triangles, hull = [first], list(first)
    for point in range(3, len(points)):
        sides = zip(hull, hull[1:] + hull[:1], strict=True)
        seen = [(start, end) for start, end in sides if turn(start, end, point) < 0.0]
        triangles += [(end, start, point) for start, end in seen]
        hidden = {start for start, _ in seen} & {end for _, end in seen}
        after = next(start for start, _ in seen if start not in hidden)
        hull = [corner for corner in hull if corner not in hidden]
        hull.insert(hull.index(after) + 1, point)
    return triangles


# %%
# A side is illegal if the angles that face it sum to more than 180 degrees; the circle of either triangle then holds
# the fourth corner. Its flip raises the smallest of the six angles of the two triangles.


def angles(triangles: list[Triangle]) -> np.ndarray:
    """Angles (n, 3) at the corners of triangles, degrees."""
    corners = points[np.array(triangles)]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]
    return np.degrees(np.arctan2(cross, (ahead * back).sum(axis=2)))


def flipped(start: list[Triangle], choose: np.random.Generator) -> tuple[list[Triangle], list[list[Triangle]]]:
    """The triangulation without illegal sides, and those on the way there: sides are tried in random order."""
    facing = {(a, b): c for t in start for a, b, c in (t, t[1:] + t[:1], t[2:] + t[:2])}
    waiting, history = sorted(facing), []
    while waiting:
        a, b = waiting.pop(choose.integers(len(waiting)))
        if (a, b) not in facing or (b, a) not in facing:
            continue
        c, d = facing[a, b], facing[b, a]
        at_c, at_d = angles([(c, a, b), (d, b, a)])[:, 0]
        if at_c + at_d <= 180.0 + 1e-9:
            continue
        del facing[a, b], facing[b, a]
        for triangle in ((a, d, c), (d, b, c)):
            for shift in range(3):
                i, j, k = triangle[shift:] + triangle[:shift]
                facing[i, j] = k
        waiting += [(a, d), (d, b), (b, c), (c, a)]
        history.append([(i, j, k) for (i, j), k in facing.items() if i < j and i < k])
    return history[-1], history


# %%
# **Every start, every order.** The sides are tried in five random orders. The number of flips differs, but never
# exceeds the n (n - 1) / 2 pairs of points: a diagonal that has been flipped away does not return.

start = swept()
delaunay = {tuple(sorted(triangle)) for triangle in Delaunay(points).simplices.tolist()}
pairs = len(points) * (len(points) - 1) // 2
shared = sum(tuple(sorted(triangle)) in delaunay for triangle in start)
print(f"the start has {len(start)} triangles, {shared} of them Delaunay's")
for order in range(5):
    end, history = flipped(start, np.random.default_rng(order))
    print(f"order {order}: {len(history):3} flips, of {pairs} at most")
    assert {tuple(sorted(triangle)) for triangle in end} == delaunay
    assert len(history) <= pairs

# %%
# **Empty circles** at the end, and full ones at the start.


def circles(triangles: list[Triangle]) -> tuple[np.ndarray, np.ndarray]:
    """Centres (n, 2) and radii (n,) of the circles through the corners of triangles."""
    corners = points[np.array(triangles)]
    sides = corners[:, 1:] - corners[:, :1]
    ways = np.linalg.solve(sides, 0.5 * (sides**2).sum(axis=2)[..., None])[..., 0]
    return corners[:, 0] + ways, np.linalg.norm(ways, axis=1)


full = {}
for name, triangles in (("start", start), ("end", end)):
    centres, radii = circles(triangles)
    full[name] = int((cKDTree(points).query(centres)[0] < radii - 1e-9).sum())
    print(f"{name}: {full[name]} of {len(triangles)} circles hold a point")
assert full["end"] == 0 < full["start"]

# %%
# **The smallest angle does not fall**, at any flip. Nor does the whole list of angles, sorted from the smallest on: of
# all triangulations of these points Delaunay's has the largest.

lists = [np.sort(angles(each), axis=None) for each in [start, *history]]
smallest = np.array([each[0] for each in lists])
print(f"smallest angle: {smallest[0]:.3f} degrees at the start, {smallest[-1]:.3f} at the end")
assert (np.diff(smallest) >= -1e-9).all()
for before, after in pairwise(lists):
    change = (after - before)[np.abs(after - before) > 1e-9]
    assert change[0] > 0.0

# %%
# Orange sides below are illegal.


def draw(axes: plt.Axes, triangles: list[Triangle], title: str) -> None:
    """The triangles, illegal sides in orange."""
    axes.triplot(*points.T, triangles, color="tab:blue", linewidth=0.8)
    facing = {}
    for triangle, three in zip(triangles, angles(triangles), strict=True):
        for shift in range(3):
            facing[triangle[shift - 2], triangle[shift - 1]] = three[shift]
    for (a, b), angle in facing.items():
        if a < b and angle + facing.get((b, a), 0.0) > 180.0 + 1e-9:
            axes.plot(*points[[a, b]].T, color="tab:orange", linewidth=1.2)
    axes.plot(*points.T, "k.")
    axes.set(title=title, xlabel="x", ylabel="y", xlim=(-0.02, 1.02), ylim=(-0.02, 1.02), aspect="equal")


half = len(history) // 2
figure, (first, middle, last) = plt.subplots(1, 3, figsize=(13, 4.6), layout="constrained")
draw(first, start, "start")
draw(middle, history[half - 1], f"after {half} flips")
draw(last, end, f"after {len(history)} flips: Delaunay")

figure, axes = plt.subplots(figsize=(6, 3.5), layout="constrained")
axes.plot(smallest, drawstyle="steps-post")
axes.set(xlabel="flips", ylabel="smallest angle (degrees)", ylim=(0.0, None))

# %%
# Meshes of moving generators are made with these flips too: from one iteration to the next the triangulation is
# repaired where it has to be. Here 200 generators of a square with walls move by up to a third of their mean distance.

plane = Rectangle(1.0, 1.0, "none")
before = starting_points(plane, 200, start="random", seed=1)
step = plane.spacing(200) / 3.0
after = plane.folded(before + np.column_stack([random.uniform(-step, step, (200, 2)), np.zeros(200)]))
cells = PlaneCells(before, plane)


def inner(cells: PlaneCells) -> set[Triangle]:
    """The triangles of generators alone, without images, whose centres are within the square."""
    within = ((cells.circumcenters >= 0.0) & (cells.circumcenters <= 1.0)).all(axis=1)
    triangles = cells.triangles[within & (cells.triangles < 200).all(axis=1)]
    return {tuple(sorted(triangle)) for triangle in triangles.tolist()}


old = inner(cells)
cells.update(after, before)
new = inner(cells)
everywhere = {tuple(sorted(triangle)) for triangle in Delaunay(after[:, :2]).simplices.tolist()}
mesh = plane_mesh(after, plane)
made_anew = mesh.cells_on_vertex[(mesh.cells_on_vertex >= 0).all(axis=1)]
print(f"{len(new - old)} of {len(new)} triangles are new; all of them are Delaunay's")
assert new <= everywhere
assert new == {tuple(sorted(triangle)) for triangle in made_anew.tolist()}
assert max(trisk.validate_mesh(mesh).values()) < 1e-9
