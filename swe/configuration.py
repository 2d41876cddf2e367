"""What determines a run besides mesh and case: options as the user gives them, and as the run record stores them."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from mesh.discrete.operators import vanishing_edges
from mesh.integrals.quadrature import Sampling
from mesh.plain import plain_number
from mesh.voronoi_mesh import VoronoiMesh
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError
from swe.integrators import STEPPINGS, Integrator

DEFAULT_SNAPSHOT_INTERVAL = SECONDS_PER_DAY
DEFAULT_DIAGNOSTICS_INTERVAL = SECONDS_PER_DAY / 4
DEFAULT_CHECKPOINT_INTERVAL = SECONDS_PER_DAY

SchemeName = Literal["ringler2010", "consistent"]
"""Those of `swe.run.composition.SCHEMES`."""

CHOICES = {"sampling": get_args(Sampling), "integrator": get_args(Integrator), "scheme": get_args(SchemeName)}
"""Options whose values are words."""


@dataclass(frozen=True)
class Configuration:
    """What determines a run besides mesh and case; times in seconds, dissipation in m4/s."""

    time_step: float
    snapshot_interval: float
    diagnostics_interval: float
    sampling: Sampling
    integrator: Integrator
    anticipation: float
    dissipation: float
    scheme: SchemeName
    upwinding: float
    wall_slip: float


@dataclass(frozen=True)
class Options:
    """Options of `swe.run.simulation.Simulation`, which documents them; numbers of any type become floats.

    Raises `InputError` if one has the wrong type or is out of range.
    """

    time_step: float | None = None
    snapshot_interval: float = DEFAULT_SNAPSHOT_INTERVAL
    diagnostics_interval: float = DEFAULT_DIAGNOSTICS_INTERVAL
    checkpoint_interval: float = DEFAULT_CHECKPOINT_INTERVAL
    sampling: Sampling = "point"
    integrator: Integrator = "rk4"
    anticipation: float = 0.0
    dissipation: float = 0.0
    scheme: SchemeName = "ringler2010"
    upwinding: float = 0.0
    wall_slip: float = 0.0

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if name == "time_step" and value is None:
                continue
            words = name.replace("_", " ")
            if name in CHOICES:
                if not (isinstance(value, str) and value in CHOICES[name]):
                    raise InputError(f"the {words} is {value!r}; it must be {_alternatives(CHOICES[name])}")
                object.__setattr__(self, name, str(value))
                continue
            number = plain_number(f"the {words}", value, InputError)
            if name in ("upwinding", "wall_slip"):
                if not 0.0 <= number <= 1.0:
                    raise InputError(f"the {words} is {number:g}; it must be a number from 0 to 1")
            elif name in ("anticipation", "dissipation"):
                if not 0.0 <= number < np.inf:
                    raise InputError(f"the {words} is {number:g}; it must be a finite number, and not negative")
            elif not 0.0 < number < np.inf:
                raise InputError(f"the {words} is {number:g} s; it must be positive and finite")
            object.__setattr__(self, name, number)

    def require_suitable(self, case_name: str, prescribed_wind: bool) -> None:
        """Raise `InputError` if options do not suit the case."""
        relaxed = STEPPINGS[self.integrator].relaxed
        if prescribed_wind and (relaxed or self.anticipation > 0.0 or self.dissipation > 0.0):
            raise InputError(
                f"the wind of {case_name} is prescribed; {self.integrator if relaxed else 'rrk4'}, anticipation and "
                "dissipation go with winds that evolve"
            )

        if prescribed_wind and self.upwinding > 0.0:
            raise InputError(f"the wind of {case_name} is prescribed; upwinding goes with winds that evolve")

    def require_suitable_mesh(self, mesh: VoronoiMesh) -> None:
        """Raise `InputError` if a term would divide by the length of edges of zero length."""
        none = vanishing_edges(mesh)
        if len(none) and (self.anticipation > 0.0 or self.dissipation > 0.0):
            raise InputError(
                f"edges of the mesh have no length ({len(none)}, the first of them {none[0]}, counted from 0), as four "
                "generators lie on one circle, and anticipation and dissipation divide by it; leave them out, or make "
                "another mesh"
            )

    def with_time_step(self, time_step: float) -> Configuration:
        """The configuration of the run, once its time step is known."""
        return Configuration(
            time_step,
            self.snapshot_interval,
            self.diagnostics_interval,
            self.sampling,
            self.integrator,
            self.anticipation,
            self.dissipation,
            self.scheme,
            self.upwinding,
            self.wall_slip,
        )


def _alternatives(words: tuple[str, ...]) -> str:
    """Words in quotation marks, as in 'a', 'b' or 'c'."""
    *first, last = map(repr, words)
    return f"{', '.join(first)} or {last}"
