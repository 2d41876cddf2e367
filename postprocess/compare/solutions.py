"""What runs are compared to: the exact solution of the case, a spectral reference, or another run."""

import importlib
import math
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Protocol

from cases.base import Case
from cases.finding.registry import find_case
from mesh.arrays import Array
from mesh.safe_files import name_in_text
from postprocess.compare.remap import Remap, remap_cells, remap_vertices
from postprocess.reference.stored_references import stored_path
from postprocess.runs.reading import Run, days_in_words, days_of_both, read_run
from swe.constants import SECONDS_PER_DAY
from swe.errors import InputError

PARAMETER_TOLERANCE = 1e-12
"""Relative difference up to which two values of a parameter are the same."""

LONGEST_PATH = 40
"""Characters of a path in titles."""


class Solution(Protocol):
    """Fields at any points (n,), longitude and latitude in radians, on certain days since the start or any day."""

    @property
    def name(self) -> str:
        """Its name in tables and titles."""

    @property
    def days(self) -> Sequence[float] | None:
        """Days on which it is known; None where that is any day."""

    def uncertainty(self, day: float) -> dict[str, float]:
        """Relative l2 norms of its own error, by field, where known."""

    def thickness(self, longitude: Array, latitude: Array, day: float) -> Array:
        """Thickness of the fluid, m."""

    def velocity(self, longitude: Array, latitude: Array, day: float) -> tuple[Array, Array]:
        """Zonal and meridional velocity, m/s."""

    def vorticity(self, longitude: Array, latitude: Array, day: float) -> Array:
        """Relative vorticity, 1/s."""


class ExactSolution:
    """The exact solution of a case that has one."""

    name = "exact solution"
    days = None

    def __init__(self, case: Case) -> None:
        self.case = case

    def uncertainty(self, day: float) -> dict[str, float]:
        """Empty: it has no error."""
        return {}

    def thickness(self, longitude: Array, latitude: Array, day: float) -> Array:
        """Thickness of the fluid, m."""
        return self.case.evaluated(self.case.thickness, day * SECONDS_PER_DAY)(longitude, latitude)

    def velocity(self, longitude: Array, latitude: Array, day: float) -> tuple[Array, Array]:
        """Zonal and meridional velocity, m/s."""
        return self.case.evaluated_velocity(day * SECONDS_PER_DAY)(longitude, latitude)

    def vorticity(self, longitude: Array, latitude: Array, day: float) -> Array:
        """Relative vorticity, 1/s."""
        return self.case.evaluated(self.case.vorticity, day * SECONDS_PER_DAY)(longitude, latitude)


class RunSolution:
    """A run, remapped from its mesh; on the mesh itself, its values unchanged.

    Maps to the same arrays of points are made once. The velocity is the one reconstructed at cells.
    """

    def __init__(self, run: Run) -> None:
        self.run = run
        self.name = f"{name_in_text(_short(run.directory))}, {run.mesh.n_cells} cells"
        self.days = tuple(run.days.tolist())
        self._maps: dict[tuple[str, int, int], Remap] = {}

    def uncertainty(self, day: float) -> dict[str, float]:
        """Empty: its error is not known."""
        return {}

    def thickness(self, longitude: Array, latitude: Array, day: float) -> Array:
        """Thickness of the fluid, m."""
        return self.from_cells(longitude, latitude).scalar(self.run.snapshot(day).fields["thickness"])

    def velocity(self, longitude: Array, latitude: Array, day: float) -> tuple[Array, Array]:
        """Zonal and meridional velocity, m/s."""
        fields = self.run.snapshot(day).fields
        return self.from_cells(longitude, latitude).vector(fields["velocity_zonal"], fields["velocity_meridional"])

    def vorticity(self, longitude: Array, latitude: Array, day: float) -> Array:
        """Relative vorticity, 1/s."""
        return self.from_vertices(longitude, latitude).scalar(self.run.snapshot(day).fields["relative_vorticity"])

    def from_cells(self, longitude: Array, latitude: Array) -> Remap:
        """Map from the cell centres of the run's mesh to points."""
        # A map keeps its arrays of points alive, so that no other array can get their identity.
        key = ("cells", id(longitude), id(latitude))
        if key not in self._maps:
            self._maps[key] = remap_cells(self.run.mesh, longitude, latitude)
        return self._maps[key]

    def from_vertices(self, longitude: Array, latitude: Array) -> Remap:
        """Map from the vertices of the run's mesh to points."""
        key = ("vertices", id(longitude), id(latitude))
        if key not in self._maps:
            self._maps[key] = remap_vertices(self.run.mesh, longitude, latitude)
        return self._maps[key]


def _short(directory: Path) -> str:
    """A path as given, or its last two parts if it is too long for a title."""
    whole = str(directory)
    return whole if len(whole) <= LONGEST_PATH else str(Path("...", *directory.parts[-2:]))


def case_of(run: Run) -> Case | None:
    """The case of a run with its parameters; None if it is unknown, or its file was moved or changed."""
    try:
        return find_case(run.case, run.parameters)
    except InputError:
        return None


def choose_solution(wanted: str, runs: Sequence[Run], days: Sequence[float], every: bool = False) -> Solution:
    """What to compare `runs`, which are of one case, with.

    `wanted` is "exact", the path of a reference file or of a run directory, or "auto": the exact solution if the case
    has one, else the reference that comes with the package if it is of the case and of one of `days`, or of `every`
    one, else the first run. Raises `InputError` where there is no such solution or it is one of something else.
    """
    if wanted == "auto":
        return _best_solution(runs, days, every)
    if wanted == "exact":
        return _exact_solution(runs[0])
    path = Path(wanted)
    if path.is_dir():
        other = read_run(path)
        require_same_problem(other.directory, other.case, other.parameters, runs[0])
        return RunSolution(other)
    if not path.exists():
        raise InputError(f"there is no reference '{wanted}'; give exact, auto, a reference file or a run directory")
    reference = _reference_files().read_reference(path)
    require_same_problem(path, reference.case.name, reference.case.parameters(), runs[0])
    return reference


def require_same_problem(what: Path, case: str, parameters: Mapping[str, object], run: Run) -> None:
    """Raise `InputError` where the file or directory `what` is not of the case and the parameters of `run`."""
    if case != run.case:
        raise InputError(f"{what} is of case {case}, but {run.directory} of {run.case}; compare runs of one case")
    for name in sorted(parameters.keys() & run.parameters.keys()):
        theirs, ours = parameters[name], run.parameters[name]
        if not _same(theirs, ours):
            raise InputError(
                f"{what} has {name} = {theirs!r}, but {run.directory} has {ours!r}; compare runs with equal parameters"
            )


def _same(a: object, b: object) -> bool:
    """Whether two values of a parameter are the same, numbers up to round-off."""
    if isinstance(a, float | int) and isinstance(b, float | int):
        return math.isclose(a, b, rel_tol=PARAMETER_TOLERANCE)
    return a == b


def _best_solution(runs: Sequence[Run], days: Sequence[float], every: bool) -> Solution:
    case = case_of(runs[0])
    if case is not None and case.has_exact_solution:
        return ExactSolution(case)
    try:
        stored = _stored_reference(runs[0], days, every)
    except InputError as error:
        if len(runs) == 1:
            raise
        warnings.warn(f"{error}; the first run is the reference instead", stacklevel=1)
        stored = None
    if stored is not None:
        return stored
    if len(runs) == 1:
        raise InputError(
            f"there is nothing to compare {runs[0].directory} with: no solution of {runs[0].case} with its parameters "
            f"is known on day {days_in_words(days)}; name another run or a reference file"
        )
    return RunSolution(runs[0])


def _exact_solution(run: Run) -> Solution:
    case = case_of(run)
    if case is None or not case.has_exact_solution:
        raise InputError(f"no exact solution of {run.case} is known; name a reference file or another run")
    return ExactSolution(case)


def _stored_reference(run: Run, days: Sequence[float], every: bool) -> Solution | None:
    """The reference that comes with the package for the case and parameters of `run`, or None.

    It must know one of `days`, or `every` one of them.
    """
    if stored_path(run.case) is None:
        return None
    reference = _reference_files().stored_reference(run.case)
    known = days_of_both(days, reference.days)
    if not known or (every and len(known) < len(days)):
        return None
    try:
        require_same_problem(run.directory, reference.case.name, reference.case.parameters(), run)
    except InputError:
        return None
    return reference


def _reference_files() -> ModuleType:
    """The module that reads reference files; raises `InputError` where the package that it needs is missing."""
    # Imported when it is needed: everything else here works without the optional package.
    return importlib.import_module("postprocess.reference.reference_file")
