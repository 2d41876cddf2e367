"""The same case over families and sizes of meshes: their quality beside truncation and solution errors.

A study is a folder: `meshes/` and `runs/` hold what it is made of, one mesh for each family and size and one run
for each scheme on it, and `study.csv` one row for each run. What is there and fits is not made again, so a study that
was interrupted goes on.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from cases.base import Case
from mesh.arrays import Array
from mesh.discrete.quality import mesh_quality
from mesh.files.io import read_mesh, write_mesh
from mesh.generation.generators import icosahedral_level
from mesh.geometry.surface import surface_of
from mesh.safe_files import dataset
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.compare.comparison import Comparison, compare_runs, fields_of, fields_on
from postprocess.compare.shares import error_shares, shares_as_columns
from postprocess.compare.truncation import truncation_errors
from postprocess.runs.folders import prepared_folder
from postprocess.runs.reading import Run
from postprocess.studies.families import FAMILIES, Family
from postprocess.studies.lines import run_name
from postprocess.studies.plane_families import StudyPlane
from postprocess.studies.study_folder import CONSERVATION, TABLE_FILE, StudyRow, Task, Tell, require_days, write_table
from swe.configuration import Options, SchemeName
from swe.errors import InputError

LEAST_CELLS, LARGEST_CELLS = 162, 655362


@dataclass(frozen=True)
class Plan:
    """What a study runs: `case` for `days` on `families` of meshes of about `cells` cells, errors taken at `error_day`.

    Each of the `schemes` runs on the same meshes, which are on a `plane` where there is one. Raises `InputError` if a
    family is unknown or a number of cells is not that of a bisected icosahedron, or of hexagons that fit the plane.
    """

    folder: Path
    case: Case
    days: float
    error_day: float
    families: tuple[str, ...]
    cells: tuple[int, ...]
    schemes: tuple[SchemeName, ...] = (Options.scheme,)
    plane: StudyPlane | None = None

    @property
    def known_families(self) -> dict[str, Family]:
        """Families of meshes on the surface of the case, by name."""
        return FAMILIES if self.plane is None else self.plane.families

    def __post_init__(self) -> None:
        known = self.known_families
        for family in self.families:
            if family not in known:
                raise InputError(f"there is no family of meshes named '{family}'; choose among {', '.join(known)}")
        for cells in self.cells:
            if self.plane is not None:
                for family in self.families:
                    self.plane.require_cells(family, cells)
            elif icosahedral_level(cells) is None or not LEAST_CELLS <= cells <= LARGEST_CELLS:
                raise InputError(
                    f"{cells} cells are no bisected icosahedron of a suitable size; choose among {LEAST_CELLS}, 642, "
                    f"2562, ... up to {LARGEST_CELLS}"
                )
        require_days(self.days)
        if not 0.0 < self.error_day <= self.days:
            raise InputError(
                f"errors cannot be taken on day {self.error_day:g} of a run of {self.days:g} days; choose a day within "
                "the run"
            )


@dataclass(frozen=True)
class Member:
    """One mesh and scheme of a study, the run (None if it failed) and its comparison (None if there is no solution)."""

    family: str
    scheme: SchemeName
    requested_cells: int
    mesh: VoronoiMesh
    run: Run | None
    comparison: Comparison | None
    failure: str

    @property
    def spacing(self) -> float:
        """Mean distance between neighbours, km."""
        surface = surface_of(self.mesh)
        area = float(self.mesh.area_cell.sum()) if surface.is_flat else surface.area
        return surface.mean_spacing(self.mesh.n_cells, area) * self.mesh.length_unit / 1e3


def carry_out(plan: Plan, progress: bool, tell: Tell) -> tuple[list[Member], list[StudyRow]]:
    """Do what a study still lacks, coarse meshes first, and write its table; return the finest members and all rows."""
    prepared_folder(plan.folder)
    finest: list[Member] = []
    rows: list[StudyRow] = []
    for cells in sorted(set(plan.cells)):
        finest = []  # those of coarser meshes are let go, they would fill the memory
        for family in dict.fromkeys(plan.families):
            for member in _members(plan, family, cells, progress, tell):
                finest.append(member)
                rows.append(row_of(member, plan.error_day))
                write_table(rows, plan.folder / TABLE_FILE)
    return finest, rows


def _members(plan: Plan, family: str, cells: int, progress: bool, tell: Tell) -> Iterator[Member]:
    """Read or make one mesh, and the run of each scheme on it."""
    name = f"{family}-{cells}"
    mesh = _mesh(plan.folder / "meshes" / f"{name}.nc", plan.known_families[family], cells, tell)
    for scheme in dict.fromkeys(plan.schemes):
        folder = plan.folder / "runs" / run_name(name, scheme)
        task = Task(folder, plan.case, mesh, plan.days, plan.error_day, scheme=scheme)
        run, failure = task.carry_out(progress, tell)
        comparison = None if run is None else _comparison(run, plan.error_day, tell)
        used = mesh.scaled(plan.case.radius) if run is None else run.mesh
        yield Member(family, scheme, cells, used, run, comparison, failure)


def _comparison(run: Run, day: float, tell: Tell) -> Comparison | None:
    """The run compared with the solution of its case; None, with the reason reported, if no solution is known."""
    try:
        return compare_runs(run, days=[day])
    except InputError as error:
        tell(f"no errors: {error}")
        return None


def _mesh(path: Path, family: Family, cells: int, tell: Tell) -> VoronoiMesh:
    """Read a mesh, or make it if it is missing or was made differently."""
    origin = f"mesh of a study: {family.description}; {cells} cells asked for"
    if not (path.exists() and _history(path).endswith(origin)):
        tell(f"{path.stem}: making the mesh")
        path.parent.mkdir(exist_ok=True)
        write_mesh(family.make(cells), path, origin)
    return read_mesh(path)


def _history(path: Path) -> str:
    """What a mesh file says about its origin; empty if the file cannot be read."""
    try:
        with dataset(path) as file:
            return str(file.history)
    except (OSError, AttributeError):
        return ""


def row_of(member: Member, error_day: float) -> StudyRow:
    """The line of a member: the mesh, its quality, truncation errors, solution errors and conservation."""
    row: StudyRow = {
        "family": member.family,
        "scheme": member.scheme,
        "requested_cells": member.requested_cells,
        "spacing_km": member.spacing,
        **asdict(mesh_quality(member.mesh)),
    }
    for operator, norms in asdict(truncation_errors(member.mesh, member.scheme)).items():
        row |= {f"truncation_{operator}_{name}": norms[name] for name in ("l2", "linf")}
    row["failure"] = member.failure
    if member.comparison is not None:
        row |= _errors(member, member.comparison, error_day)
    if member.run is not None:
        row |= {name: float(np.abs(member.run.series[name]).max()) for name in CONSERVATION}
        row |= {"time_step_s": member.run.time_step, "steps": member.run.steps}
    return row


def thickness_error(member: Member, day: float) -> Array:
    """Thickness of a run less that of the solution it is compared with (n_cells,), m."""
    assert member.run is not None
    assert member.comparison is not None
    ours, theirs = fields_of(member.run, day), fields_on(member.run, member.comparison.solution, day)
    return ours.thickness - theirs.thickness


def _errors(member: Member, comparison: Comparison, day: float) -> StudyRow:
    row: StudyRow = {"reference": comparison.solution.name, "error_day": day}
    for field, norms in comparison.entries[0].norms.items():
        row |= {f"{field}_{name}": value for name, value in asdict(norms).items()}
    row |= {f"uncertainty_{field}": value for field, value in comparison.solution.uncertainty(day).items()}
    shares = error_shares(member.mesh, thickness_error(member, day))
    return row | _worst_cell(member, day) | shares_as_columns(shares)


def _worst_cell(member: Member, day: float) -> StudyRow:
    """Where the error of thickness is largest, degrees or km, and how many mean distances away the mesh is irregular.

    The latter is not there if all cells are hexagons.
    """
    mesh = member.mesh
    worst = int(np.argmax(np.abs(thickness_error(member, day))))
    if mesh.on_a_sphere:
        row: StudyRow = {
            "worst_longitude": float(np.degrees(mesh.lon_cell[worst])),
            "worst_latitude": float(np.degrees(mesh.lat_cell[worst])),
        }
    else:
        row = {f"worst_{axis}_km": float(getattr(mesh, f"{axis}_cell")[worst]) / 1e3 for axis in "xy"}
    irregular = mesh.cell_points[mesh.n_edges_on_cell != 6]
    if len(irregular):
        ways = surface_of(mesh).shortest(irregular - mesh.cell_points[worst])
        row["worst_to_irregular"] = float(np.linalg.norm(ways, axis=1).min()) / (1e3 * member.spacing)
    return row
