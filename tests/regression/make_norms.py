"""Make `norms.json` anew: python tests/regression/make_norms.py."""

import json
from pathlib import Path

import numpy as np

from cases import Williamson2, Williamson5
from mesh import scvt_mesh
from postprocess.compare.norms import scalar_norms
from swe import Simulation

NORMS_FILE = Path(__file__).with_name("norms.json")
CELLS, DAYS, TIME_STEP = 642, 5, 900.0


def compute_norms() -> dict[str, float]:
    """Norms of the change over a few days, on a small converged mesh."""
    norms = {}
    mesh = scvt_mesh(CELLS)
    for case in (Williamson2(), Williamson5()):
        simulation = Simulation(mesh, case, time_step=TIME_STEP)
        start = simulation.state.copy()
        simulation.run(DAYS, progress=False)
        h, area = simulation.state.thickness, simulation.mesh.area_cell
        of_thickness = scalar_norms(h, start.thickness, area)
        norms[f"{case.name} l1 of thickness"] = of_thickness.l1
        norms[f"{case.name} l2 of thickness"] = of_thickness.l2
        norms[f"{case.name} linf of thickness"] = of_thickness.linf
        norms[f"{case.name} rms of normal velocity"] = float(np.sqrt(np.mean(simulation.state.normal_velocity**2)))
        norms[f"{case.name} potential enstrophy"] = simulation.invariants.potential_enstrophy
    return norms


if __name__ == "__main__":
    NORMS_FILE.write_text(json.dumps(compute_norms(), indent=2) + "\n")
