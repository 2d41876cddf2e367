"""Speed of the mesh generation, for a quiet machine: python tests/benchmarks/scvt_speed.py [LEVEL ...].

Prints one L-BFGS iteration against one convex hull of the same 163842 points, measured in turn, and for each bisection
level the time from nothing to a validated mesh file, with iterations, residual and peak memory (each level in a
process of its own).
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull

from mesh.generation.generators import icosahedral_mesh
from mesh.generation.optimizer import Limits, Optimizer
from mesh.triangulation.ordering import renumber

TOLERANCES = {6: 1e-6, 7: 1e-6, 8: 1e-6, 9: 1e-5}
"""Bisection level (10*4^level + 2 cells) and residual wanted."""

REPEATS = 5

CHILD = """
import resource, sys, time, tracemalloc
begin = time.perf_counter()
import numpy as np
from mesh import mesh_from_points, write_mesh
from mesh.generation.optimizer import Limits
from mesh.generation.scvt import generate_scvt, optimize, starting_mesh
from mesh.mesh_request import MeshRequest

cells, tolerance, path = int(sys.argv[1]), float(sys.argv[2]), sys.argv[3]
result = generate_scvt(MeshRequest(cells, tolerance=tolerance))
converged = time.perf_counter() - begin
write_mesh(mesh_from_points(result.points, result.triangles), path)
total = time.perf_counter() - begin
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
per_iteration = 1e9 * np.median(np.diff(result.history.seconds)) / cells
start = starting_mesh(cells)
tracemalloc.start()
optimize(*start, limits=Limits(iterations=2))
memory = tracemalloc.get_traced_memory()[1] / cells
print(f"{cells:8d} cells to {result.history.residual[-1]:.1e} in {result.history.iterations} iterations: "
      f"{converged:.1f} s, with validated mesh file {total:.1f} s; {per_iteration:.0f} ns per cell and iteration, "
      f"the optimiser holds {memory:.0f} B per cell at most; {peak / 1e9:.2f} GB in all")
"""


def against_hull(level: int) -> None:
    """One iteration, everything included, against one convex hull, in turn."""
    points, triangles = renumber(*icosahedral_mesh(level))
    Optimizer(points, triangles).run(Limits(iterations=2))  # compile
    ratios = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        ConvexHull(points)
        hull = time.perf_counter() - begin
        seconds = np.diff(Optimizer(points, triangles).run(Limits(iterations=12)).history.seconds)
        ratios.append(hull / np.median(seconds))
        print(f"{len(points)} points: hull {hull:.2f} s, iteration {1e3 * np.median(seconds):.1f} ms")
    print(f"median ratio {np.median(ratios):.1f}")


def main() -> None:
    """Measure what the arguments ask for, all levels by default."""
    against_hull(7)
    for level in [int(argument) for argument in sys.argv[1:]] or TOLERANCES:
        with tempfile.TemporaryDirectory() as folder:
            arguments = [str(10 * 4**level + 2), str(TOLERANCES[level]), str(Path(folder) / "mesh.nc")]
            subprocess.run([sys.executable, "-c", CHILD, *arguments], check=True)


if __name__ == "__main__":
    main()
