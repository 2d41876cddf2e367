"""The manufactured solution: its forcing is what the equations leave, and the model follows it with second order."""

import dataclasses

import numpy as np
import pytest

from cases import Manufactured
from mesh import VoronoiMesh, hexagon_mesh
from mesh.arrays import Array
from mesh.integrals.quadrature import Sampling
from swe import InputError, Simulation
from swe.configuration import SchemeName
from tests.cases.plane.slopes import Slopes, component, relative_error

ROW = 0.5 * np.sqrt(3.0)
FLOWS = [
    Manufactured(),
    Manufactured(period=2e4, x_length=7e5, y_length=9e5, amplitude=-35.0, coriolis_parameter=-2e-4),
]


def plane(columns: int) -> VoronoiMesh:
    return hexagon_mesh((1e6, 1e6 * ROW), (columns, columns))


@pytest.mark.parametrize("case", FLOWS, ids=["default", "other"])
def test_forcing_is_what_the_nonlinear_equations_leave(case: Manufactured) -> None:
    x, y = np.random.default_rng(5).uniform(0.0, 1e6, (2, 200))
    slopes, time = Slopes(x, y, 5e3), 5e3
    along, across = component(case.velocity, 0), component(case.velocity, 1)
    h, (u, v), f = case.thickness(x, y, time), case.velocity(x, y, time), case.coriolis(x, y)
    divergence = slopes.in_x(along) + slopes.in_y(across)
    advection = u * slopes.in_x(case.thickness) + v * slopes.in_y(case.thickness)
    source = slopes.in_time(case.thickness) + advection + h * divergence
    expected = [
        slopes.in_time(part) + u * slopes.in_x(part) + v * slopes.in_y(part) + turned + case.gravity * slope
        for part, turned, slope in (
            (along, -f * v, slopes.in_x(case.thickness)),
            (across, f * u, slopes.in_y(case.thickness)),
        )
    ]
    np.testing.assert_allclose(case.source(x, y, time), source, atol=1e-8 * np.abs(source).max())
    np.testing.assert_allclose(case.acceleration(x, y, time), expected, atol=1e-8 * np.abs(expected).max())
    vorticity = slopes.in_x(across) - slopes.in_y(along)
    np.testing.assert_allclose(case.vorticity(x, y, time), vorticity, atol=1e-8 * np.abs(vorticity).max())
    # Products of unknowns are so large a part of both that they have been tested.
    assert np.abs(advection).max() > 0.1 * np.abs(source).max()
    assert np.abs(u * slopes.in_x(along)).max() > 0.02 * np.abs(expected).max()


def test_the_term_is_the_forcing_at_edges_and_cells() -> None:
    mesh, case = plane(8), Manufactured()
    (term,), state = case.terms(), case.state_on(mesh)
    assert term.acceleration is not None
    assert term.source is not None
    along, across = case.acceleration(mesh.x_edge, mesh.y_edge, 7e3)
    expected = along * np.cos(mesh.angle_edge) + across * np.sin(mesh.angle_edge)
    np.testing.assert_allclose(term.acceleration(mesh, state, 7e3), expected, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_array_equal(term.source(mesh, state, 7e3), case.source(mesh.x_cell, mesh.y_cell, 7e3))


def errors(columns: int, scheme: SchemeName, sampling: Sampling = "point") -> Array:
    """Relative l2 errors after a period of the departure of the thickness from its mean, and of the velocity."""
    case = Manufactured()
    simulation = Simulation(plane(columns), case, scheme=scheme, sampling=sampling)
    simulation.run(days=0.5, progress=False)
    mesh, found = simulation.mesh, simulation.state
    exact = case.state_on(mesh, simulation.time, sampling)
    height = relative_error(found.thickness - case.depth, exact.thickness - case.depth, mesh.area_cell)
    velocity = relative_error(found.normal_velocity, exact.normal_velocity, mesh.dc_edge * mesh.dv_edge)
    return np.array([height, velocity])


@pytest.mark.parametrize(
    ("scheme", "sampling"), [("ringler2010", "point"), ("consistent", "point"), ("ringler2010", "mean")]
)
def test_errors_are_of_second_order(scheme: SchemeName, sampling: Sampling) -> None:
    coarse, fine = (errors(columns, scheme, sampling) for columns in (16, 32))
    assert (np.log2(coarse / fine) > 1.95).all()
    assert (fine < 0.016).all()


@pytest.mark.slow
def test_errors_are_of_second_order_on_finer_meshes() -> None:
    every = np.array([errors(columns, "consistent") for columns in (32, 64, 128)])
    orders = np.log2(every[:-1] / every[1:])
    assert (orders > 1.95).all()
    assert (orders < 2.05).all()


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="manufactured needs a mesh on a plane with --periodic xy, and this one has"):
        Manufactured().state_on(hexagon_mesh((1e6, 1e6 * ROW), (8, 8), "x"))
    with pytest.raises(InputError, match="period is 0; it must be positive"):
        dataclasses.replace(Manufactured(), period=0.0)
    assert not Manufactured(beta=1e-11).has_exact_solution
