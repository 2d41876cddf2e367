"""A spectral-transform shallow-water model, the independent reference for the finite-volume one.

Vorticity, divergence and surface height as spherical harmonics, products on a Gauss-Legendre grid without
aliasing: the vorticity-divergence form of Hack and Jakob (1992), NCAR/TN-343+STR, equations (2.8) to (2.10), with
classical RK4 instead of semi-implicit leapfrog. It shares no operator with the models on Voronoi meshes.
"""

import numpy as np

from cases.base import Case
from postprocess.reference.harmonics import Coefficients, Harmonics
from swe.constants import SECONDS_PER_DAY
from swe.errors import RunError

HYPERDIFFUSION_POWER = 4
"""Power of the Laplacian: del^8."""

TOPOGRAPHY_OVERSAMPLING = 4
"""The mountain has kinks: its harmonics are taken on a grid finer by this factor, to avoid aliasing."""

SECONDS_PER_HOUR = 3600.0


class SpectralModel:
    """The shallow-water equations of `case` up to total wavenumber `truncation`.

    `damping_hours` is the time in which del^8 hyperdiffusion damps the highest wavenumber of vorticity, divergence
    and surface height to 1/e; infinity switches it off. A state is (3, n_coefficients) complex: vorticity, 1/s,
    divergence, 1/s, and surface height, m.
    """

    def __init__(self, case: Case, truncation: int, damping_hours: float = 1.0) -> None:
        self.case = case
        self.harmonics = Harmonics(truncation, case.radius)
        wavenumber = self.harmonics.laplacian / self.harmonics.laplacian.min()
        self._damping = wavenumber**HYPERDIFFUSION_POWER / (damping_hours * SECONDS_PER_HOUR)
        fine = Harmonics(truncation, case.radius, TOPOGRAPHY_OVERSAMPLING)
        self.topography = fine.from_grid(case.evaluated(case.topography)(*fine.points))
        self._topography_on_grid = self.harmonics.to_grid(self.topography)
        self._coriolis = case.evaluated(case.coriolis)(*self.harmonics.points)

    def initial_state(self) -> Coefficients:
        """Coefficients of the case's initial state, whose flow has no divergence."""
        harmonics, case = self.harmonics, self.case
        streamfunction = case.evaluated(case.streamfunction)(*harmonics.points)
        thickness = case.evaluated(case.thickness)(*harmonics.points)
        surface = thickness + case.evaluated(case.topography)(*harmonics.points)
        vorticity = harmonics.laplacian * harmonics.from_grid(streamfunction)
        return np.stack([vorticity, np.zeros_like(vorticity), harmonics.from_grid(surface)])

    def tendency(self, state: Coefficients) -> Coefficients:
        """Time derivative of a state, without hyperdiffusion: Hack and Jakob (1992), equations (2.8) to (2.10)."""
        harmonics = self.harmonics
        vorticity, divergence, surface = state
        u, v = harmonics.velocity_on_grid(vorticity, divergence)
        absolute_vorticity = harmonics.to_grid(vorticity) + self._coriolis
        thickness = harmonics.to_grid(surface) - self._topography_on_grid
        curl, convergence = harmonics.curl_and_divergence(absolute_vorticity * u, absolute_vorticity * v)
        flux_divergence = harmonics.curl_and_divergence(thickness * u, thickness * v)[1]
        energy = harmonics.from_grid(0.5 * (u * u + v * v)) + self.case.gravity * surface
        return np.stack([-convergence, curl - harmonics.laplacian * energy, -flux_divergence])

    def step(self, state: Coefficients, time_step: float) -> Coefficients:
        """State after one step of classical RK4 and of exact hyperdiffusion, seconds."""
        first = self.tendency(state)
        second = self.tendency(state + 0.5 * time_step * first)
        third = self.tendency(state + 0.5 * time_step * second)
        fourth = self.tendency(state + time_step * third)
        following = state + time_step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
        return following * np.exp(-time_step * self._damping)

    def stable_step(self, state: Coefficients) -> float:
        """The time step, s, at 0.9 of RK4's limit for gravity waves on the flow at the highest wavenumber."""
        harmonics = self.harmonics
        u, v = harmonics.velocity_on_grid(state[0], state[1])
        thickness = harmonics.to_grid(state[2]) - self._topography_on_grid
        speed = np.max(np.hypot(u, v) + np.sqrt(self.case.gravity * np.maximum(thickness, 0.0)))
        return float(0.9 * 2.0 * np.sqrt(2.0) * harmonics.radius / (speed * (harmonics.truncation + 1)))

    def integrate(self, state: Coefficients, days: float, time_step: float) -> Coefficients:
        """State after `days` in equal steps of at most `time_step` seconds; raise `RunError` where it is not finite."""
        steps = int(np.ceil(days * SECONDS_PER_DAY / time_step))
        for number in range(1, steps + 1):
            state = self.step(state, days * SECONDS_PER_DAY / steps)
            if not np.isfinite(state.sum()):
                raise RunError(
                    f"the spectral model of {self.case.name} at T{self.harmonics.truncation} failed after "
                    f"{number} steps; a smaller time step than {time_step:g} s or more damping may help"
                )
        return state
