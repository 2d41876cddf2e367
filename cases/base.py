"""What a test case is: documented parameters and pure functions of position and time."""

import math
import traceback
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import MISSING, Field, asdict, dataclass, field, fields
from typing import Any, ClassVar, TypeVar, cast

import numpy as np

from cases.differences import gradient, laplacian
from mesh.arrays import Array
from mesh.discrete.operators import normal_velocity_from_streamfunction
from mesh.integrals.quadrature import Sampling, SphereFunction, sample_cells
from mesh.plain import plain, plain_number
from mesh.shown import Rows, Shown, in_words
from mesh.voronoi_mesh import VoronoiMesh
from swe.constants import EARTH_RADIUS, GRAVITY, ROTATION_RATE
from swe.equations.terms import Forcing
from swe.errors import InputError
from swe.state import State

SMALLEST, LARGEST = 1e-6, 1e12
"""Bounds on radius, m, and gravity, m/s2, within which the arithmetic neither overflows nor underflows."""

RADIUS_TOLERANCE = 1e-9
"""Largest relative difference between the radii of mesh and case; files round the radius."""

MOST_TOLD = 9
"""Parameters of its own that a case shows; what has more tells how many."""

LARGEST_ANGLE = 4.0 * math.pi
"""Two turns, radians: beyond, a number is likely to be in degrees."""

Default = TypeVar("Default")


def parameter(default: Default, units: str, meaning: str) -> Default:
    """A parameter of a case, for the body of its class: `height: float = parameter(10.0, "m", "Height of the bump")`.

    It is a field of a dataclass, whose metadata hold `units`, empty where there are none, and `meaning`.
    """
    return cast(Default, field(default=default, metadata={"units": units, "meaning": meaning}))


@dataclass(frozen=True, repr=False)
class Case(Shown, ABC):
    """A shallow-water test case on a rotating sphere; longitudes and latitudes in radians.

    A case must define `thickness`, `streamfunction`, `title` and `recommended_days`; everything else has a default.
    Its functions return one value per position, or a single number. Those that take a time are valid at any time
    where `has_exact_solution` is true, and otherwise only at time zero.
    """

    name: ClassVar[str]
    """What the user types; an object that comes from a file has its own, FILE.py:CLASS with the whole path."""

    title: ClassVar[str]
    """What it is, in a few words."""

    recommended_days: ClassVar[float]
    """How long the paper runs it."""

    reference: ClassVar[str] = ""
    """The paper, starting with authors and year."""

    convergence_order: ClassVar[float | None] = None
    """Lowest accepted order of convergence, in cell spacing, of the l2 error norm of thickness on the recommended day.

    It holds between successive converged uniform meshes of 10242, 40962, ... cells; None where there is no exact
    solution or no order to expect.
    """

    prescribed_wind: ClassVar[bool] = False
    """Whether the wind stays as it is at the start, so that only thickness evolves."""

    radius: float = parameter(EARTH_RADIUS, "m", "Radius of the sphere")
    gravity: float = parameter(GRAVITY, "m/s2", "Acceleration of gravity")
    rotation_rate: float = parameter(ROTATION_RATE, "1/s", "Angular velocity of the sphere")

    _bounded: ClassVar[tuple[str, ...]] = ("radius", "gravity")
    """Parameters that must lie between `SMALLEST` and `LARGEST`."""

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        # A dataclass writes a `__repr__` of its own where it finds none in the class itself.
        cls.__repr__ = cls.__repr__  # type: ignore[method-assign]

    def _title_and_rows(self) -> tuple[str, Rows]:
        """Name, title and parameters with their units; those that all cases have share a line."""
        days = getattr(self, "recommended_days", None)
        paper = [in_words(self.reference.partition(", https://")[0])] if self.reference else []
        rows = {
            "title": in_words(getattr(self, "title", "none")),
            "reference": ", ".join(paper + ([] if days is None else [f"{in_words(days)} days"])),
        }
        common, own = fields(Case), fields(self)[len(fields(Case)) :]
        rows["sphere"] = ", ".join(f"{each.name.replace('_', ' ')} {_value_in_words(self, each)}" for each in common)
        told = own if len(own) <= MOST_TOLD else own[: MOST_TOLD - 1]
        rows |= {each.name.replace("_", " "): _value_in_words(self, each) for each in told}
        if told != own:
            rows["more parameters"] = f"{len(own) - len(told)}; see parameters()"
        name = getattr(self, "name", type(self).__name__)
        return f"Case {name}", rows

    def __post_init__(self) -> None:
        for each in fields(self):
            value = plain(getattr(self, each.name))
            if isinstance(each.default, float):
                value = plain_number(each.name, value, InputError)
            object.__setattr__(self, each.name, value)
        for name, value in self.parameters().items():
            if isinstance(value, float) and not math.isfinite(value):
                raise InputError(f"{name} is {value}; give a finite number")
        self.require_positive(*self._bounded)
        for name in self._bounded:
            if not SMALLEST < self.parameters()[name] < LARGEST:
                raise InputError(
                    f"{name} is {self.parameters()[name]:g}; it must be between {SMALLEST:g} and {LARGEST:g}"
                )

    def require_positive(self, *names: str) -> None:
        """Raise `InputError` where one of these parameters is not positive."""
        for name in names:
            value = self.parameters()[name]
            if value <= 0.0:
                raise InputError(f"{name} is {value:g}; it must be positive")

    def require_angles(self, *names: str) -> None:
        """Raise `InputError` if one of these parameters is too large to be an angle in radians."""
        for name in names:
            value = self.parameters()[name]
            if abs(value) > LARGEST_ANGLE:
                raise InputError(f"{name} is {value:g}; it is in radians, and must be between -4 pi and 4 pi")

    @property
    def has_exact_solution(self) -> bool:
        """Whether the solution is known at any time."""
        return False

    @property
    def background_depth(self) -> float:
        """Constant part of the thickness, m; error norms are those of the thickness above it."""
        return 0.0

    @abstractmethod
    def thickness(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Thickness of the fluid, m, at `time` seconds."""

    @abstractmethod
    def streamfunction(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Streamfunction psi, m2/s, at `time` seconds; the velocity is k x grad(psi)."""

    def velocity(self, longitude: Array, latitude: Array, time: float = 0.0) -> tuple[Array, Array]:
        """Eastward and northward velocity, m/s, at `time` seconds; differences of the streamfunction by default."""
        eastward, northward = gradient(self.evaluated(self.streamfunction, time), longitude, latitude)
        return -northward / self.radius, eastward / self.radius

    def vorticity(self, longitude: Array, latitude: Array, time: float = 0.0) -> Array:
        """Relative vorticity, 1/s, at `time` seconds; differences of the streamfunction by default."""
        return laplacian(self.evaluated(self.streamfunction, time), longitude, latitude) / self.radius**2

    def topography(self, longitude: Array, latitude: Array) -> Array:
        """Height of the bottom, m; flat unless the case says otherwise."""
        return np.zeros(longitude.shape)

    def coriolis(self, longitude: Array, latitude: Array) -> Array:
        """Coriolis parameter, 1/s, of rotation about the polar axis."""
        return 2.0 * self.rotation_rate * np.sin(latitude)

    def terms(self) -> tuple[Forcing, ...]:
        """What the case adds to the equations, such as wind or rain; nothing by default."""
        return ()

    def state_on(self, mesh: VoronoiMesh, time: float = 0.0, sampling: Sampling = "point") -> State:
        """State at `time` seconds on `mesh`: thickness at the cells, normal velocity from the streamfunction.

        Thickness is that of the centres, or the mean over each cell where `sampling` is "mean". The streamfunction
        is evaluated at vertices, so that the velocity has no discrete divergence. Raises `InputError` if the radii of
        mesh and case differ.
        """
        if not math.isclose(mesh.sphere_radius, self.radius, rel_tol=RADIUS_TOLERANCE):
            raise InputError(
                f"the mesh has a radius of {mesh.sphere_radius:.10g} m, but {self.name} one of {self.radius:.10g} m; "
                f"scale the mesh first, mesh.scaled({self.radius:.10g})"
            )
        streamfunction = self.evaluated(self.streamfunction, time)(*mesh.coordinates("vertex"))
        return State(
            sample_cells(mesh, self.evaluated(self.thickness, time), sampling),
            normal_velocity_from_streamfunction(mesh, streamfunction),
        )

    def initial_state(self, mesh: VoronoiMesh, sampling: Sampling = "point") -> State:
        """State at time zero on `mesh`, whose radius is that of the case."""
        return self.state_on(mesh, 0.0, sampling)

    def topography_on(self, mesh: VoronoiMesh, sampling: Sampling = "point") -> Array:
        """Height of the bottom at cells (n_cells,), m, at the centres or as means over the cells."""
        return sample_cells(mesh, self.evaluated(self.topography), sampling)

    def coriolis_on(self, mesh: VoronoiMesh) -> Array:
        """Coriolis parameter at vertices (n_vertices,), 1/s."""
        return self.evaluated(self.coriolis)(*mesh.coordinates("vertex"))

    def parameters(self) -> dict[str, float]:
        """Parameters by name."""
        return asdict(self)

    def evaluated(self, function: Callable[..., Array], *time: float) -> SphereFunction:
        """`function` of this case as a function of longitude and latitude; raises `InputError` if it fails."""

        def field(longitude: Array, latitude: Array) -> Array:
            return self._spread(function, self._outcome(function, longitude, latitude, *time), longitude)

        return field

    def evaluated_velocity(self, time: float = 0.0) -> Callable[[Array, Array], tuple[Array, Array]]:
        """`velocity` at `time` as a function of longitude and latitude; raises `InputError` where it fails."""

        def field(longitude: Array, latitude: Array) -> tuple[Array, Array]:
            outcome = self._outcome(self.velocity, longitude, latitude, time)
            if not isinstance(outcome, tuple | list | np.ndarray) or len(outcome) != 2:
                raise InputError(
                    f"velocity of {self.name} gives {type(outcome).__name__}; it must give an eastward and a "
                    "northward velocity"
                )
            eastward, northward = (self._spread(self.velocity, part, longitude) for part in outcome)
            return eastward, northward

        return field

    def _outcome(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """The value that `function` of this case returns."""
        try:
            return function(*arguments)
        except InputError:
            raise
        except (Exception, SystemExit) as error:
            place = _place_of_call(error)
            raise InputError(f"{function.__name__} of {self.name} failed{place}: {error!r}") from error

    def _spread(self, function: Callable[..., Any], outcome: object, longitude: Array) -> Array:
        """`outcome` of `function`, a single number or one per position, as an array with one value per position."""
        try:
            values = np.asarray(outcome, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"{function.__name__} of {self.name} does not return numbers: {error!r}") from error
        if values.shape not in ((), longitude.shape):
            raise InputError(
                f"{function.__name__} of {self.name} gives an array of shape {values.shape} for positions of "
                f"shape {longitude.shape}; it must give one value for each position, or one number"
            )
        return np.array(np.broadcast_to(values, longitude.shape))


def _value_in_words(case: Case, parameter: Field[Any]) -> str:
    """The value of a parameter with its units, and the default where it is another."""
    value, default, units = getattr(case, parameter.name), plain(parameter.default), parameter.metadata.get("units", "")
    changed = default is not MISSING and repr(value) != repr(default)
    return in_words(value, units) + (f" (default {in_words(default)})" if changed else "")


def _place_of_call(error: BaseException) -> str:
    """The line at which the function called here raised `error`, as part of a sentence."""
    called = traceback.extract_tb(error.__traceback__)[1:2]
    return "".join(f" in line {frame.lineno} of {frame.filename}" for frame in called)
