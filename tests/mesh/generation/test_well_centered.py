import numpy as np
import pytest

from mesh import mesh_from_points, mesh_quality
from mesh.density.named import NAMED, uniform
from mesh.discrete.quality import triangle_quality
from mesh.generation.optimizer import Limits, ScvtResult
from mesh.generation.reseed import SHAKEN_RINGS, reseed
from mesh.generation.scvt import generate_scvt, optimize
from mesh.generation.well_centered import GOAL, _objective, _penalty, _turn_if_better, _Work, well_center
from mesh.geometry.sphere import normalize
from mesh.mesh_request import MeshRequest
from mesh.triangulation.delaunay import delaunay
from mesh.triangulation.half_edges import build_twins, first_corners
from mesh.triangulation.ordering import sort_triangles
from mesh.triangulation.repair import flip
from mesh.triangulation.triangle_quality import near_bad_triangles, qualities
from tests.mesh.plain_moments import mass_and_moment

CIRCLE = NAMED["refined-circle"]


@pytest.fixture(scope="module")
def circle() -> ScvtResult:
    return generate_scvt(MeshRequest(2562, CIRCLE, "random-root", tolerance=1e-5, seed=1))


def test_compiled_quality_is_that_of_the_mesh(circle: ScvtResult) -> None:
    mesh = mesh_from_points(circle.points, circle.triangles)
    np.testing.assert_allclose(qualities(mesh.cell_points, mesh.cells_on_vertex), triangle_quality(mesh), rtol=1e-12)


def test_penalty_has_the_gradient_it_says(circle: ScvtResult) -> None:
    points, triangles, goal = circle.points.copy(), circle.triangles, 0.95
    gradient = np.zeros_like(points)
    value = _penalty(points, triangles, goal, gradient)
    direction = np.random.default_rng(0).normal(size=points.shape)
    step = 1e-7
    ahead, behind = (
        _penalty(points + sign * step * direction, triangles, goal, np.zeros_like(points)) for sign in (1, -1)
    )
    assert (ahead - behind) / (2 * step) == pytest.approx(np.sum(gradient * direction), rel=1e-4)
    assert value > 0.0


def test_no_obtuse_triangle_is_left(circle: ScvtResult) -> None:
    before = mesh_quality(mesh_from_points(circle.points, circle.triangles, CIRCLE, "refined-circle"))
    better = well_center(circle.points, circle.triangles, CIRCLE)
    after = mesh_quality(mesh_from_points(better.points, better.triangles, CIRCLE, "refined-circle"))
    assert before.obtuse > 0
    assert before.q_min < 0.83
    assert after.obtuse == 0
    assert after.q_min == pytest.approx(better.least_quality)
    assert after.q_min >= GOAL
    assert better.residual_before == pytest.approx(before.residual, rel=1e-6)
    assert better.residual == pytest.approx(after.residual, rel=1e-6)
    assert better.residual < 0.1
    np.testing.assert_array_equal(sort_triangles(better.triangles), sort_triangles(delaunay(better.points)))


def test_most_generators_stay(circle: ScvtResult) -> None:
    better = well_center(circle.points, circle.triangles, CIRCLE)
    moved = (better.points != circle.points).any(axis=1)
    assert 0.0 < moved.mean() < 0.6


def test_good_meshes_are_left_alone() -> None:
    result = generate_scvt(MeshRequest(642))
    better = well_center(result.points, result.triangles)
    np.testing.assert_array_equal(better.points, result.points)
    assert better.residual == better.residual_before


def test_bad_surroundings_grow_by_rings(circle: ScvtResult) -> None:
    counts = [near_bad_triangles(circle.points, circle.triangles, 0.8, rings).sum() for rings in (0, 1, 2, 50)]
    assert 0 < counts[0] < counts[1] < counts[2] < counts[3] == 2562


def test_reseeding_never_makes_the_mesh_worse() -> None:
    start = optimize(
        np.ascontiguousarray(generate_scvt(MeshRequest(300, start="random", tolerance=1e-5, seed=2)).points)
    )
    fixed = np.zeros(300, bool)

    def converge(points: np.ndarray) -> ScvtResult:
        return optimize(points, limits=Limits(1e-5))

    better = reseed(start, converge, wanted=0.95, tries=4, seed=0, fixed=fixed)
    lacking = [np.maximum(0, 0.95 - qualities(r.points, r.triangles)).sum() for r in (start, better)]
    assert lacking[1] < lacking[0]
    assert better.history.residual[-1] <= 1e-5


def test_no_round_begins_without_time(circle: ScvtResult) -> None:
    late = well_center(circle.points, circle.triangles, CIRCLE, seconds=0.0)
    assert late.least_quality < GOAL
    assert late.residual == late.residual_before
    np.testing.assert_array_equal(late.points, circle.points)


def test_only_generators_near_bad_triangles_are_shaken() -> None:
    start = generate_scvt(MeshRequest(300, start="random", tolerance=1e-4, seed=2))
    fixed = np.arange(300) % 7 == 0
    near = near_bad_triangles(start.points, start.triangles, 0.9, SHAKEN_RINGS) & ~fixed
    assert 0 < near.sum() < (~fixed).sum()
    asked: list[np.ndarray] = []

    def converge(points: np.ndarray) -> ScvtResult:
        asked.append((points != start.points).any(axis=1))
        return start

    reseed(start, converge, wanted=0.9, tries=1, seed=0, fixed=fixed)
    np.testing.assert_array_equal(asked, [near])


def test_a_round_moves_the_cells_towards_their_centroids() -> None:
    """Where no triangle is near the goal there is no penalty: each cell goes to the centroid of its region."""
    start = generate_scvt(MeshRequest(162)).points
    points = normalize(start + 0.02 * np.random.default_rng(0).normal(size=start.shape))
    work = _Work(points, delaunay(points), uniform, None, np.inf)
    _, moment = mass_and_moment(points, delaunay(points))
    free = np.zeros(162, bool)
    free[[3, 50, 120]] = True
    work.relax(free, 0.1)
    np.testing.assert_allclose(work.points[free], normalize(moment)[free], atol=1e-6)
    np.testing.assert_array_equal(work.points[~free], points[~free])


def test_sides_turn_where_that_makes_the_worse_triangle_better() -> None:
    """One side of a Delaunay triangulation is turned the wrong way, and is turned back."""
    points = np.ascontiguousarray(generate_scvt(MeshRequest(162)).points)
    triangles = np.array(delaunay(points), np.int32, order="C")
    twins = build_twins(triangles, 162)
    first_corner, degrees = first_corners(triangles, 162)
    arrays = (triangles, twins, first_corner, degrees)
    flip(*arrays, 7, twins.ravel()[7])
    assert qualities(points, triangles).min() < 0.8
    assert _turn_if_better(points, *arrays, 0.0) == 0
    assert _turn_if_better(points, *arrays, 0.9) == 1
    np.testing.assert_array_equal(sort_triangles(triangles), sort_triangles(delaunay(points)))
    np.testing.assert_array_equal(twins, build_twins(triangles, 162))
    np.testing.assert_array_equal(degrees, np.bincount(triangles.ravel()))
    np.testing.assert_array_equal(triangles.ravel()[first_corner], np.arange(162))


def test_objective_has_the_gradient_it_says(circle: ScvtResult) -> None:
    """Also with respect to the lengths of the unknowns, on which the points do not depend."""
    random, goal, n = np.random.default_rng(1), 0.95, len(circle.points)
    free = np.arange(5, 45)
    unknowns = 0.7 * circle.points[free].ravel()
    anchors = normalize(circle.points[free] + 0.01 * random.normal(size=(40, 3)))
    weights = random.uniform(1.0, 2.0, 40)

    def value_and_slope(at: np.ndarray) -> tuple[float, np.ndarray]:
        slope = np.empty(120)
        others = (circle.points.copy(), free, circle.triangles, anchors, weights, goal, np.empty((n, 3)))
        return _objective(at, *others, slope), slope

    direction, step = random.normal(size=120), 1e-7
    (ahead, _), (behind, _) = (value_and_slope(unknowns + sign * step * direction) for sign in (1, -1))
    slope = value_and_slope(unknowns)[1]
    assert (ahead - behind) / (2 * step) == pytest.approx(slope @ direction, rel=1e-4)
    np.testing.assert_allclose((slope * unknowns).reshape(-1, 3).sum(axis=1), 0.0, atol=1e-12)
