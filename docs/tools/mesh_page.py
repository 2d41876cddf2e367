"""Write docs/meshes, the page on mesh generation: python docs/tools/mesh_page.py FOLDER --max-level 9."""

import argparse
from pathlib import Path

from mesh.density.named import NAMED
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Limits
from mesh.generation.scvt import generate_scvt
from mesh.mesh_request import MeshRequest
from mesh_report import (
    CIRCLE_CELLS,
    PUBLISHED_CIRCLE,
    RANDOM_CELLS,
    SHAKE,
    Start,
    Tell,
    circle_meshes,
    distribution_figure,
    measured,
    meshes_figure,
    optimizer_figure,
    optimizer_histories,
    random_meshes,
    sizes_figure,
    starts_lines,
)
from postprocess.runs.folders import prepared_folder
from postprocess.studies.table1 import UNIFORM_TOLERANCE, Row, table1
from postprocess.studies.table1_page import ON_MEASURES, PAGE, save, table1_section

COARSE_CELLS = 2562
NESTED_CELLS = 5781
PUBLISHED_NESTED = (5.7079, 0.9006, 0.4012, 0.9904, 0.7114)
"""Ju, Ringler and Gunzburger (2011): the mesh of equation (13)."""

NESTED_STARTS = (("icosahedral", 0), ("fibonacci", 0), ("random", 0), ("random", 1))

VARIABLE_TOLERANCE = 1e-6


def nested_meshes(tell: Tell) -> list[Start]:
    """Nested meshes of equation (13), from converged ones with several starts, the icosahedral first."""
    box = NAMED["refined-box"]
    meshes = []
    for start, seed in NESTED_STARTS:
        coarse = generate_scvt(MeshRequest(COARSE_CELLS, start=start, seed=seed))
        limits = Limits(VARIABLE_TOLERANCE)
        result = nested_scvt(coarse.points, coarse.triangles, box, NESTED_CELLS, limits, seed=seed)
        meshes.append(measured(start, seed, result, box))
        tell(f"nested mesh from {start} {seed}: least q {meshes[-1].quality.q_min:.4f}")
    return meshes


def write_page(folder: Path, rows: list[Row], tell: Tell) -> Path:
    """Make everything but Table 1, whose `rows` are given, and write page and figures to `folder`."""
    prepared_folder(folder)
    circles = circle_meshes(VARIABLE_TOLERANCE, tell)
    nested = nested_meshes(tell)
    random = random_meshes(UNIFORM_TOLERANCE, tell)
    histories = optimizer_histories(tell)
    shown = {
        f"uniform, {random[0].mesh.n_cells} cells": random[0].mesh,
        f"refined-circle, {CIRCLE_CELLS} cells": circles[0].mesh,
        f"nested refined-box, {NESTED_CELLS} cells": nested[0].mesh,
    }
    published = ", ".join(f"{value:.4f}" for value in PUBLISHED_NESTED)
    text = f"""# Mesh generation: quality and convergence

Made by `python docs/tools/mesh_page.py FOLDER --max-level {rows[-1].level}`. {ON_MEASURES}

{(2 * chr(10)).join(table1_section(rows))}

## Variable resolution

{save(meshes_figure(shown), folder, "meshes")}

{save(sizes_figure(shown), folder, "sizes")}

Refined-circle, equation (12), {CIRCLE_CELLS} cells, from several starts; a variable-resolution SCVT is one of many
local minima:

{chr(10).join(starts_lines(circles))}

{save(distribution_figure(circles, PUBLISHED_CIRCLE, "Refined-circle over starts"), folder, "refined-circle-starts")}

Nested, equation (13), {NESTED_CELLS} cells, generators beyond the transition held fixed, from converged meshes of
{COARSE_CELLS} cells with several starts (published: {published}). The residual is that of the generators that
were free, which are converged to {VARIABLE_TOLERANCE:g}:

{chr(10).join(starts_lines(nested))}

{save(distribution_figure(nested, PUBLISHED_NESTED, "Nested refined-box over starts"), folder, "nested-starts")}

## Random starts and the icosahedron

{chr(10).join(starts_lines(random))}

Dislocations are pairs of a pentagon and a heptagon beyond the twelve pentagons that every mesh has; energies in
rad² sr. The icosahedral mesh of {RANDOM_CELLS} cells has none, and less energy than any mesh from random points, whose
hundreds of dislocations separate grains of hexagons. It is a local minimum all the same, not the global one: shaken by
{100 * SHAKE:.0f}% of the spacing and converged again, it ends with a few dislocations and, for some seeds, less
energy, but with a much smaller least σ. Who wants an even mesh for the C-grid scheme, whose local errors follow the
shape of the worst cells, takes the icosahedral start; the others serve to see how far results depend on the symmetry
of the mesh.

## Optimisers

{save(optimizer_figure(histories), folder, "optimizers")}

L-BFGS, preconditioned by Lloyd's step and coarse icosahedral grids, converges in hundreds of iterations from random
points, where dislocations have to move, and in 20 to 40 from the bisected icosahedron, nearly the same number at any
size. Lloyd's method needs thousands, and four times as many for four times the cells. The probabilistic methods, whose
iteration here is as many samples as there are cells or more, stop at the noise of their samples.
"""
    (folder / PAGE).write_text(text)
    return folder / PAGE


def main() -> None:
    """Make Table 1 and the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--max-level", type=int, default=6)
    arguments = parser.parse_args()
    rows = table1(arguments.max_level, UNIFORM_TOLERANCE, lambda row: print(f"level {row.level}", flush=True))
    print(write_page(arguments.folder, rows, lambda line: print(line, flush=True)))


if __name__ == "__main__":
    main()
