"""A short run of test case 5, and all that is compared of it."""

import hashlib
from typing import Any

from cases import Williamson5
from mesh import VoronoiMesh
from mesh.arrays import Array
from swe import Simulation
from swe.diagnostics.outputs import Evaluation, diagnostics_row, series_of
from swe.parallel.processes import ONE_PROCESS, Processes

DAYS = 0.25
TIME_STEP = 1200.0


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
