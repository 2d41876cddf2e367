"""The dual vortex: geostrophic balance at the start, what the model conserves, and its symmetry."""

import numpy as np
import pytest

from cases import DualVortex
from mesh import VoronoiMesh, build_operators, hexagon_mesh
from swe import InputError, Simulation
from swe.configuration import SchemeName
from swe.run.composition import SCHEMES
from tests.cases.plane.slopes import Slopes

ROW = 0.5 * np.sqrt(3.0)
LENGTHS = np.array([5e6, 5e6 * ROW])


def plane(columns: int) -> VoronoiMesh:
    return hexagon_mesh(LENGTHS, (columns, columns))


def test_the_start_is_two_cyclones_in_geostrophic_balance() -> None:
    case = DualVortex()
    x, y = np.random.default_rng(5).uniform(0.0, 1.0, (2, 200)) * LENGTHS[:, None]
    slopes = Slopes(x, y, 0.0, metres=1e3)
    u, v = case.velocity(x, y)
    forces = case.gravity * slopes.in_x(case.thickness), -case.gravity * slopes.in_y(case.thickness)
    size = np.abs(forces).max()
    np.testing.assert_allclose(case.coriolis_parameter * v, forces[0], atol=1e-9 * size)
    np.testing.assert_allclose(case.coriolis_parameter * u, forces[1], atol=1e-9 * size)
    vorticity = slopes.in_x(lambda *place: case.velocity(*place)[1]) - slopes.in_y(
        lambda *place: case.velocity(*place)[0]
    )
    np.testing.assert_allclose(case.vorticity(x, y), vorticity, atol=1e-8 * np.abs(vorticity).max())
    np.testing.assert_allclose(slopes.in_x(case.streamfunction), v, atol=1e-8 * np.abs(v).max())
    middle = np.array([0.4, 0.6]), np.array([0.4, 0.6])
    at = middle[0] * LENGTHS[0], middle[1] * LENGTHS[1]
    assert (case.vorticity(*at) > 0.5 * case.coriolis_parameter).all()
    # One depression is nearly all there is in its middle, and nothing of it is left far away.
    lacking = 4.0 * np.pi * case.vortex_width**2 * case.vortex_depth
    np.testing.assert_allclose(case.thickness(*at), 675.0 + lacking, atol=4.0)
    assert case.thickness(np.zeros(1), np.zeros(1))[0] == pytest.approx(750.0 + lacking, abs=0.2)


def test_the_start_neither_has_seams_nor_divergence() -> None:
    mesh, case = plane(16), DualVortex()
    state = case.state_on(mesh)
    divergence = build_operators(mesh).divergence @ state.normal_velocity
    speed = np.abs(state.normal_velocity).max()
    assert np.abs(divergence).max() < 1e-12 * speed / mesh.dc_edge.min()
    assert speed > 10.0
    x, y = np.random.default_rng(3).uniform(0.0, 1e6, (2, 20))
    np.testing.assert_allclose(case.thickness(x, y), case.thickness(x + LENGTHS[0], y - LENGTHS[1]), rtol=1e-13)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_integrals_are_kept_and_the_flow_stays_symmetric(scheme: SchemeName) -> None:
    simulation = Simulation(plane(32), DualVortex(), scheme=scheme, integrator="rrk4")
    before, start = vars(simulation.invariants), simulation.state.thickness.copy()
    simulation.run(days=5.0, progress=False)
    after, height = vars(simulation.invariants), simulation.state.thickness
    assert simulation.loops == "fused"
    assert np.abs(height - start).max() > 20.0
    energies = [each["kinetic_energy"] + each["potential_energy"] for each in (before, after)]
    assert after["mass"] == pytest.approx(before["mass"], rel=1e-14)
    assert energies[1] == pytest.approx(energies[0], rel=1e-14)
    change = after["absolute_vorticity"] - before["absolute_vorticity"]
    assert abs(change) < 1e-13 * before["planetary_vorticity_magnitude"]
    # Half a turn about the middle of the plane numbers the cells of the mesh from the last to the first.
    np.testing.assert_allclose(height[::-1], height, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize(("anticipation", "low", "high"), [(0.0, 0.015, 0.035), (0.5, -0.025, -0.005)])
def test_potential_enstrophy_grows_unless_anticipation_takes_it(anticipation: float, low: float, high: float) -> None:
    simulation = Simulation(plane(32), DualVortex(), anticipation=anticipation)
    before = simulation.invariants.potential_enstrophy
    simulation.run(days=5.0, progress=False)
    assert low < simulation.invariants.potential_enstrophy / before - 1.0 < high


def test_what_does_not_fit_is_refused() -> None:
    with pytest.raises(InputError, match="x_length = 5000000 m, but the mesh after 4000000 m in x"):
        DualVortex().state_on(hexagon_mesh((4e6, 4e6 * ROW), (8, 8)))
    with pytest.raises(InputError, match="coriolis_parameter is 0; the vortices are in geostrophic balance"):
        DualVortex(coriolis_parameter=0.0)
