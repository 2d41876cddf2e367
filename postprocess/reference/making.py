"""Reference solutions by the spectral model: made, stored as harmonics in one small file a case, read and evaluated."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from cases.base import Case
from mesh.arrays import Array
from postprocess.reference.harmonics import Coefficients, Harmonics, truncated, truncation_of
from postprocess.reference.spectral_model import SpectralModel
from postprocess.runs.reading import DAY_TOLERANCE, days_in_words
from swe.errors import InputError

REFERENCE_DAYS = {"williamson5": (5.0, 10.0, 15.0), "williamson6": (14.0,), "galewsky": (6.0,)}
"""Days of the stored references by case."""

LARGEST_TRUNCATION = 8191
LAST_DAY = 1e5
LEAST_DAMPING_HOURS = 1e-9
LEAST_TRUNCATION = 16

MEASURES = ("thickness", "velocity", "vorticity")
"""Quantities that have an uncertainty."""

TellPart = Callable[[str, float], None]
"""Receives what is being done and the fraction that is done."""


@dataclass(frozen=True, eq=False)
class Reference:
    """Solution of `case` on some `days` as harmonics (n_days, 3, n_coefficients): see `SpectralModel` for the fields.

    `differences` (n_truncations, n_days, 3) are the relative l2 norms of what runs of the lower `truncations` differ
    by from the stored one, in thickness, velocity and vorticity; the last of them is taken as the uncertainty.
    """

    case: Case
    days: tuple[float, ...]
    coefficients: Coefficients
    truncations: tuple[int, ...]
    differences: Array
    settings: str
    history: str

    @property
    def name(self) -> str:
        """What the reference is, for tables."""
        return f"spectral T{self.truncations[-1]}"

    def uncertainty(self, day: float) -> dict[str, float]:
        """Relative l2 norm by which the solution of half the truncation differs, by measure."""
        return dict(zip(MEASURES, self.differences[-1, self._row(day)].tolist(), strict=True))

    def thickness(self, longitude: Array, latitude: Array, day: float) -> Array:
        """Thickness of the fluid at points, m: surface height less the exact topography."""
        harmonics, (_, _, surface) = self._on(day)
        return harmonics.at_points(surface, longitude, latitude) - self.case.evaluated(self.case.topography)(
            longitude, latitude
        )

    def velocity(self, longitude: Array, latitude: Array, day: float) -> tuple[Array, Array]:
        """Zonal and meridional velocity at points, m/s."""
        harmonics, (vorticity, divergence, _) = self._on(day)
        return harmonics.velocity_at_points(vorticity, divergence, longitude, latitude)

    def vorticity(self, longitude: Array, latitude: Array, day: float) -> Array:
        """Relative vorticity at points, 1/s."""
        harmonics, (vorticity, _, _) = self._on(day)
        return harmonics.at_points(vorticity, longitude, latitude)

    def _on(self, day: float) -> tuple[Harmonics, Coefficients]:
        coefficients = self.coefficients[self._row(day)]
        return Harmonics(truncation_of(coefficients), self.case.radius), coefficients

    def _row(self, day: float) -> int:
        rows = np.flatnonzero(np.abs(np.array(self.days) - day) < DAY_TOLERANCE)
        if not len(rows):
            known = days_in_words(self.days)
            raise InputError(f"the reference of {self.case.name} has no day {day:g}; choose among {known}")
        return int(rows[0])


def make_reference(
    case: Case, days: Sequence[float], truncation: int, damping_hours: float, history: str, tell: TellPart
) -> Reference:
    """Run the spectral model at `truncation`, its half and its quarter, and keep what the half resolves.

    What lies beyond half the truncation is a part of what the two highest truncations differ by. Raises `InputError`
    where an argument is out of range or the case is not one of the full equations, `RunError` where a run fails.
    """
    if case.radius == 0.0:
        raise InputError(f"{case.name} is on a plane, and the spectral model is on a sphere; choose another case")
    if not LEAST_TRUNCATION <= truncation <= LARGEST_TRUNCATION:
        raise InputError(
            f"the truncation is {truncation}; give at least {LEAST_TRUNCATION}, at most {LARGEST_TRUNCATION}"
        )
    wrong = [day for day in days if not 0.0 < day <= LAST_DAY]
    if wrong or not days:
        raise InputError(
            f"a reference of {case.name} cannot be given on day {min(wrong, default=0.0):g}; give days after the "
            f"start, up to {LAST_DAY:g}"
        )
    if not damping_hours > LEAST_DAMPING_HOURS:
        raise InputError(
            f"the damping time is {damping_hours:g} hours; it must be above {LEAST_DAMPING_HOURS:g}, or inf for none"
        )
    if case.prescribed_wind:
        raise InputError(
            f"{case.name} prescribes its wind, which the spectral model does not do; it has an exact solution"
        )
    truncations = (truncation // 4, truncation // 2, truncation)
    models = [SpectralModel(case, each, damping_hours) for each in truncations]
    *coarser, finest = (_solve(model, days, tell) for model in models)
    differences = np.array(
        [[_differences(models[-1], *pair) for pair in zip(each, finest, strict=True)] for each in coarser]
    )
    settings = f"RK4, del^8 hyperdiffusion that damps wavenumber {truncation} in {damping_hours:g} hours"
    kept = truncated(finest, truncation // 2)
    return Reference(case, tuple(days), kept, truncations, differences, settings, history)


def _solve(model: SpectralModel, days: Sequence[float], tell: TellPart) -> Coefficients:
    """States of the spectral model (n_days, 3, n_coefficients) on `days`, which ascend."""
    state = model.initial_state()
    time_step = model.stable_step(state)
    states, reached = [], 0.0
    for day in days:
        for leg_end in [*np.arange(np.floor(reached) + 1.0, day), day]:
            state = model.integrate(state, leg_end - reached, time_step)
            reached = float(leg_end)
            tell(f"T{model.harmonics.truncation}", reached / days[-1])
        states.append(state)
    return np.stack(states)


def _differences(model: SpectralModel, coarse: Coefficients, fine: Coefficients) -> list[float]:
    """Relative l2 norms by which a state of lower truncation differs from one of `model`, by measure."""
    harmonics = model.harmonics
    padded = np.zeros_like(fine)
    padded[:, harmonics.degree <= truncation_of(coarse)] = coarse
    depth = fine[2:] - model.topography
    pairs = (
        (padded[2:] - fine[2:], depth),
        (harmonics.potential_speeds(padded[:2] - fine[:2]), harmonics.potential_speeds(fine[:2])),
        (padded[:1] - fine[:1], fine[:1]),
    )
    return [harmonics.root_mean_square(error) / harmonics.root_mean_square(whole) for error, whole in pairs]
