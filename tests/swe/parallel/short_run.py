"""A short run of test case 5, and all that is compared of it; and blocks of cells for it."""

import hashlib
from typing import Any

import numpy as np

from cases import Williamson5
from mesh import VoronoiMesh
from mesh.arrays import Array, Index
from swe import Simulation
from swe.diagnostics.outputs import Evaluation, diagnostics_row, series_of
from swe.parallel.processes import ONE_PROCESS, Processes

DAYS = 0.25
TIME_STEP = 1200.0


def blocks_by_longitude(mesh: VoronoiMesh, blocks: int) -> Index:
    """The block of every cell: runs of about equally many cells by longitude."""
    result = np.empty(mesh.n_cells, np.int64)
    result[np.argsort(mesh.lon_cell, kind="stable")] = np.arange(mesh.n_cells) * blocks // mesh.n_cells
    return result


def row_of(simulation: Simulation) -> dict[str, float]:
    """All series of the diagnostics at the present time."""
    now = Evaluation(
        simulation.model,
        simulation.state,
        simulation.time,
        simulation.courant_number,
        simulation.method.tendency,
        simulation.initial_invariants,
    )
    return diagnostics_row(now, series_of(simulation.model.terms), None)


def fields_of(simulation: Simulation) -> dict[str, tuple[str, Array]]:
    """Fields by name, with the places where they are."""
    state, diagnosis = simulation.state, simulation.model.diagnose(simulation.state)
    return {
        "thickness": ("cells", state.thickness),
        "normal_velocity": ("edges", state.normal_velocity),
        "kinetic_energy": ("cells", diagnosis.kinetic_energy),
        "relative_vorticity": ("vertices", diagnosis.relative_vorticity),
        "potential_vorticity": ("vertices", diagnosis.potential_vorticity),
    }


def hash_of(values: Array) -> str:
    return hashlib.sha256(values.tobytes()).hexdigest()


def short_run(mesh: VoronoiMesh, options: dict[str, Any], processes: Processes = ONE_PROCESS) -> Simulation:
    simulation = Simulation(mesh, Williamson5(), processes=processes, **{"time_step": TIME_STEP, **options})
    simulation.run(days=DAYS, progress=False)
    return simulation
