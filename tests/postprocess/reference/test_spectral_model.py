import dataclasses

import numpy as np
import pytest

pytest.importorskip("ducc0")

from cases import find_case
from cases.williamson import Williamson2
from mesh import VoronoiMesh
from postprocess.reference.spectral_model import SpectralModel
from swe import Simulation
from swe.errors import RunError


@pytest.mark.parametrize("angle", [0.0, 0.05, np.pi / 2 - 0.05, np.pi / 2])
def test_steady_flow_has_no_tendency(angle: float) -> None:
    """Test case 2 is resolved exactly: what remains is round-off of the terms that balance each other."""
    case = Williamson2(angle=angle)
    model = SpectralModel(case, 42)
    state = model.initial_state()
    vorticity, divergence, surface = np.abs(model.tendency(state)).max(axis=1)
    frequency = 2.0 * case.rotation_rate
    # Derivatives amplify round-off at wavenumber 42 over the balanced terms, which have wavenumbers 1 and 2.
    assert vorticity < 1e-12 * frequency * np.abs(state[0]).max()
    assert divergence < 1e-11 * case.gravity * np.abs(model.harmonics.laplacian * state[2]).max()
    assert surface < 1e-14 * frequency * np.abs(state[2]).max()


def test_mass_and_vorticity_are_conserved_and_energy_is_without_damping() -> None:
    """Products free of aliasing: what is left of energy's change is the truncation of cubic terms and of time."""
    model = SpectralModel(find_case("williamson6"), 42, damping_hours=np.inf)
    start = model.initial_state()
    end = model.integrate(start, 1.0, model.stable_step(start))
    assert end[2, 0] == pytest.approx(start[2, 0], rel=1e-14)
    assert abs(end[0, 0]) < 1e-14 * np.abs(start[0]).max()
    assert energy(model, end) == pytest.approx(energy(model, start), rel=1e-7)


def energy(model: SpectralModel, state: np.ndarray) -> float:
    """Mean total energy per area, of a flat bottom."""
    harmonics = model.harmonics
    u, v = harmonics.velocity_on_grid(state[0], state[1])
    h = harmonics.to_grid(state[2])
    density = 0.5 * h * (u**2 + v**2) + 0.5 * model.case.gravity * h**2
    return float(harmonics.from_grid(density)[0].real)


def test_time_stepping_is_of_fourth_order() -> None:
    model = SpectralModel(find_case("williamson5"), 21, damping_hours=np.inf)
    start = model.initial_state()
    exact = model.integrate(start, 0.5, 300.0)
    errors = [np.abs(model.integrate(start, 0.5, step) - exact)[2].max() for step in (2400.0, 1200.0)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.35)


def test_hyperdiffusion_damps_the_highest_wavenumber_at_its_time() -> None:
    # Without rotation, as a vorticity on a rotating sphere gives some of itself to waves.
    flat = dataclasses.replace(find_case("lake-at-rest"), mountain_height=0.0, rotation_rate=0.0)
    model = SpectralModel(flat, 21, damping_hours=2.0)
    state = np.zeros_like(model.initial_state())
    highest = np.flatnonzero(model.harmonics.degree == 21)[0]
    state[2, 0] = 1e5
    state[0, highest] = 1e-20  # too weak a vorticity to do anything else
    for _ in range(4):
        state = model.step(state, 1800.0)
    assert abs(state[0, highest]) == pytest.approx(1e-20 * np.exp(-1.0), rel=1e-12, abs=0.0)


def test_both_models_agree(larger_mesh: VoronoiMesh) -> None:
    """Two models without a common operator come to the same mountain flow; an error of sign would show."""
    case = find_case("williamson5")
    model = SpectralModel(case, 42)
    state = model.initial_state()
    state = model.integrate(state, 2.0, model.stable_step(state))
    simulation = Simulation(larger_mesh, case)
    simulation.run(2.0, progress=False)
    mesh = simulation.mesh
    surface = simulation.state.thickness + simulation.model.topography
    error = surface - model.harmonics.at_points(state[2], mesh.lon_cell, mesh.lat_cell)
    moved = surface - (case.thickness(mesh.lon_cell, mesh.lat_cell) + simulation.model.topography)
    assert np.linalg.norm(error) < 0.2 * np.linalg.norm(moved)


def test_failure_is_told() -> None:
    model = SpectralModel(find_case("williamson5"), 21, damping_hours=np.inf)
    with (
        np.errstate(all="ignore"),
        pytest.raises(RunError, match=r"T21 failed after .* a smaller time step than 6000 s"),
    ):
        model.integrate(model.initial_state(), 30.0, 6000.0)
