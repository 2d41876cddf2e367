"""What a simulation shows of itself."""

from dataclasses import asdict
from pathlib import Path

from mesh.shown import Rows, in_words
from mesh.voronoi_mesh import coast_in_words, mesh_in_words
from swe.configuration import Configuration
from swe.constants import SECONDS_PER_DAY
from swe.equations.model import ShallowWaterModel
from swe.numerics_in_words import numerics_in_words
from swe.output.description import Moment
from swe.run.case import Case


def rows_of_simulation(
    case: Case, model: ShallowWaterModel, configuration: Configuration, loops: str, now: Moment, directory: Path | None
) -> Rows:
    """Case, mesh, what computes it, how far it is and where it is written.

    Asks no other process: where several share the mesh, it is this one's part that is told of.
    """
    shared = f"shared by {model.processes.count}, {model.cells} cells in all" if model.processes.count > 1 else ""
    numerics = numerics_in_words(asdict(configuration), (term.name for term in model.forcings))
    numerics["integrator"] += f", {loops} loops"
    return {
        "case": in_words(getattr(case, "title", "")),
        "mesh": mesh_in_words(model.mesh),
        "processes": shared,
        "coast": coast_in_words(model.mesh) if model.processes.count == 1 else "",
        **numerics,
        "step": f"{configuration.time_step:g} s, Courant number {now.courant_number:.3g}",
        "reached": f"day {now.time / SECONDS_PER_DAY:g}, {now.steps} steps",
        "output": "none" if directory is None else str(directory),
    }
