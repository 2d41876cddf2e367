"""Write the page on mesh generation that `trisk quality --table1 -o FOLDER` makes."""

from pathlib import Path

from mesh.density.named import NAMED
from mesh.generation.nested import nested_scvt
from mesh.generation.optimizer import Limits
from mesh.generation.scvt import generate_scvt
from mesh.mesh_request import MeshRequest
from postprocess.pages.mesh_report import (
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
    save,
    sizes_figure,
    starts_lines,
    table1_lines,
)
from postprocess.pages.table1 import Row
from postprocess.runs.folders import prepared_folder

PAGE = "README.md"
COARSE_CELLS = 2562
NESTED_CELLS = 5781
PUBLISHED_NESTED = (5.7079, 0.9006, 0.4012, 0.9904, 0.7114)
"""Ju, Ringler and Gunzburger (2011): the mesh of equation (13)."""

NESTED_STARTS = (("icosahedral", 0), ("fibonacci", 0), ("random", 0), ("random", 1))

UNIFORM_TOLERANCE = 1e-6
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

Made by `trisk quality --table1 --max-level {rows[-1].level} -o FOLDER`. Measures as in Ju, Ringler and Gunzburger
(2011), section 4: μ is the largest over the smallest distance between neighbours, σ the shortest over the longest
distance of a cell to its neighbours, q the quality of Delaunay triangles. The residual is the largest distance between
a generator and the constrained centroid of its cell, in mean spacings.

## Table 1, ours and published

{chr(10).join(table1_lines(rows))}

The published table has slips: row 3 is shifted (its bisection σ and q are those of the SCVT, and its SCVT ones repeat
row 2), the SCVT's μ of row 4 breaks the sequence, and q avg of rows 8 and 9 cannot be. From row 7 on the published
SCVTs are not converged: μ drifts with the residual that is left. On the way to convergence μ, σ avg and q avg
overshoot, so look at the residual before comparing digits.

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
