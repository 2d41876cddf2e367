"""Cost of a fused step with a coast, per cell: `python -m tests.benchmarks.coast_cost [CELLS ...]`.

Steps on a sphere, on the sea that `random_sea` makes of it, and on a sphere of about as many cells as the sea has, all
in turns in one process. Prints medians of the turns' ratios.
"""

import sys
import time

import numpy as np

from cases import Williamson5
from mesh import VoronoiMesh, scvt_mesh
from swe import Simulation
from tests.cut_mesh import random_sea

TURNS = 41

SECONDS_PER_TURN = 0.1


class Turns:
    """Repeated steps of test case 5 on one mesh."""

    def __init__(self, mesh: VoronoiMesh, **options: object) -> None:
        simulation = Simulation(mesh, Williamson5(), **options)  # type: ignore[arg-type]
        self.method, self.state = simulation.method, simulation.state
        self.step, self.cells = 0.1 * simulation.configuration.time_step, mesh.n_cells
        self.count = 1
        self.count = max(1, round(SECONDS_PER_TURN / min(self.take() * mesh.n_cells for _ in range(3))))

    def take(self) -> float:
        """Processor time of a step and cell, s, over one turn."""
        state, start = self.state.copy(), time.process_time()
        self.method.advance(state, self.step, self.count)
        return (time.process_time() - start) / (self.count * self.cells)


def main(sizes: list[int]) -> None:
    """Print a row for each size and setting."""
    print("| cells | sea | options | sea / sphere | sea / sphere as large as the sea |")
    print("|---|---|---|---|---|")
    settings: list[dict[str, object]] = [{}, {"wall_slip": 0.5}, {"scheme": "consistent"}, {"integrator": "fbrk3"}]
    for cells in sizes:
        sphere = scvt_mesh(cells)
        sea = random_sea(sphere)
        similar = scvt_mesh(sea.n_cells)
        for options in settings:
            runs = [Turns(mesh, **options) for mesh in (sphere, sea, similar)]
            times = np.array([[run.take() for run in runs] for _ in range(TURNS)])
            ratios = " | ".join(f"{np.median(times[:, 1] / times[:, other]):.3f}" for other in (0, 2))
            named = ", ".join(f"{name} {value}" for name, value in options.items()) or "rk4"
            print(f"| {cells} | {sea.n_cells} | {named} | {ratios} |", flush=True)


if __name__ == "__main__":
    main([int(word) for word in sys.argv[1:]] or [10242, 40962])
