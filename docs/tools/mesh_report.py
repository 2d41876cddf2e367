"""What the page on mesh generation shows: variable-resolution meshes over several starts, optimisers compared."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from mesh.density.named import Density, uniform
from mesh.discrete.quality import Quality, mesh_quality
from mesh.generation.optimizer import History, Limits, ScvtResult
from mesh.generation.pipeline import mesh_of
from mesh.generation.scvt import density_of, generate_scvt, optimize, starting_mesh
from mesh.geometry.sphere import mean_spacing, normalize
from mesh.mesh_request import MeshRequest
from mesh.voronoi_mesh import VoronoiMesh
from postprocess.figures.maps import draw_mollweide, draw_orthographic
from postprocess.studies.table1 import QUALITY_LABELS, QUALITY_MEASURES

PUBLISHED_CIRCLE = (5.4018, 0.8712, 0.4533, 0.9854, 0.6886)
"""Ju, Ringler and Gunzburger (2011): mu, sigma_avg, sigma_min, q_avg, q_min of the mesh of equation (12)."""

CIRCLE_CELLS = 2562
OPTIMIZER_CELLS = 2562
RANDOM_CELLS = 10242
RANDOM_SEEDS = range(5)
SHAKEN_SEEDS = range(3)
SHAKE = 0.2
"""Size of random displacements of a converged icosahedral mesh, in mean spacings."""

CIRCLE_STARTS = [("icosahedral", 0), ("fibonacci", 0)] + [
    (start, seed) for start in ("random", "random-root") for seed in range(3)
]
OPTIMIZER_LIMITS = {
    "lbfgs": Limits(1e-8),
    "multilevel": Limits(1e-8),
    "lloyd": Limits(1e-8, 3000),
    "probabilistic": Limits(1e-8, 60),
    "macqueen": Limits(1e-8, 60),
}
"""How far each optimiser goes in the comparison; the last three would need too long to get there."""

ROUND_OFF = 1e-13

Tell = Callable[[str], None]
"""Called with a line on what has been done."""


@dataclass(frozen=True)
class Start:
    """One converged mesh of a family, and the start that it came from."""

    start: str
    seed: int
    mesh: VoronoiMesh
    quality: Quality
    history: History

    @property
    def dislocations(self) -> int:
        """Pairs of a pentagon and a heptagon, beyond the twelve pentagons that no mesh can do without."""
        return int(np.count_nonzero(self.mesh.n_edges_on_cell == 5)) - 12


def converge_from(request: MeshRequest) -> Start:
    """Converge one mesh and measure it."""
    return measured(request.start or "icosahedral", request.seed, generate_scvt(request), density_of(request))


def measured(start: str, seed: int, result: ScvtResult, density: Density = uniform) -> Start:
    """The mesh of a result with its quality."""
    mesh = mesh_of(result, density)
    return Start(start, seed, mesh, mesh_quality(mesh), result.history)


def circle_meshes(tolerance: float, tell: Tell) -> list[Start]:
    """Refined-circle meshes from all `CIRCLE_STARTS`."""
    meshes = []
    for start, seed in CIRCLE_STARTS:
        meshes.append(converge_from(MeshRequest(CIRCLE_CELLS, "refined-circle", start, tolerance=tolerance, seed=seed)))
        tell(f"refined-circle from {start} {seed}: {meshes[-1].history.iterations} iterations")
    return meshes


def random_meshes(tolerance: float, tell: Tell) -> list[Start]:
    """Uniform meshes: the icosahedral one, those from it after a shake, and those from random points."""
    meshes = [converge_from(MeshRequest(RANDOM_CELLS, tolerance=tolerance))]
    for seed in SHAKEN_SEEDS:
        meshes.append(_shaken(meshes[0], seed, tolerance))
    for seed in RANDOM_SEEDS:
        meshes.append(converge_from(MeshRequest(RANDOM_CELLS, start="random", tolerance=tolerance, seed=seed)))
    for mesh in meshes:
        tell(f"{RANDOM_CELLS} cells, {mesh.start} {mesh.seed}: {mesh.dislocations} dislocations")
    return meshes


def _shaken(start: Start, seed: int, tolerance: float) -> Start:
    """Displace all generators of a converged mesh at random and converge it again."""
    points = start.mesh.cell_points
    step = SHAKE * mean_spacing(len(points)) * np.random.default_rng(seed).normal(size=points.shape)
    result = optimize(normalize(points + step), limits=Limits(tolerance))
    return measured("icosahedral, shaken", seed, result)


def optimizer_histories(tell: Tell) -> dict[str, History]:
    """Histories of all optimisers from the same random points.

    The multilevel method has its own start; its history is that of its finest level.
    """
    histories = {}
    for method, limits in OPTIMIZER_LIMITS.items():
        if method == "multilevel":
            request = MeshRequest(OPTIMIZER_CELLS, method=method, tolerance=limits.tolerance)
            histories[method] = generate_scvt(request).history
        else:
            start = starting_mesh(OPTIMIZER_CELLS, "random")
            histories[method] = optimize(*start, method, limits=limits).history
        tell(f"{method}: residual {histories[method].residual[-1]:.1e} after {histories[method].iterations} iterations")
    return histories


def optimizer_figure(histories: dict[str, History]) -> Figure:
    """Residual, and energy above the lowest that any reached, against iteration and time."""
    figure = Figure(figsize=(11.0, 7.0), layout="constrained")
    panels = figure.subplots(2, 2, sharex="col", sharey="row")
    for method, history in histories.items():
        above = np.array(history.energy) / min(history.energy) - 1.0
        above[above <= ROUND_OFF] = np.nan
        iterations, seconds = np.arange(len(above)) + 1, np.maximum(history.seconds, 1e-3)
        for column, x in enumerate((iterations, seconds)):
            panels[0, column].loglog(x, history.residual, label=method)
            panels[1, column].loglog(x, above, label=method)
    panels[0, 0].set_ylabel("residual (mean spacings)")
    panels[1, 0].set_ylabel("energy over its own minimum, less one")
    panels[1, 0].set_xlabel("iteration, counted from 1")
    panels[1, 1].set_xlabel("time (s)")
    panels[0, 1].legend()
    for axes in panels.flat:
        axes.grid(alpha=0.3)
    figure.suptitle(f"Optimisers from random points (multilevel: icosahedral), {OPTIMIZER_CELLS} cells")
    return figure


def distribution_figure(meshes: list[Start], published: tuple[float, ...], title: str) -> Figure:
    """Each measure over the starts as points, with the published value as a line."""
    figure = Figure(figsize=(11.0, 3.6), layout="constrained")
    kinds = sorted({mesh.start for mesh in meshes})
    for axes, name, label, value in zip(
        figure.subplots(1, 5), QUALITY_MEASURES, QUALITY_LABELS, published, strict=True
    ):
        for position, kind in enumerate(kinds):
            values = [getattr(mesh.quality, name) for mesh in meshes if mesh.start == kind]
            axes.plot([position] * len(values), values, "o", alpha=0.7)
        axes.axhline(value, color="black", linewidth=0.8, linestyle="--")
        axes.set_xticks(range(len(kinds)), kinds, rotation=60, fontsize=7)
        axes.set_xlim(-0.5, len(kinds) - 0.5)
        axes.set_title(label)
    figure.suptitle(f"{title} (dashed: published)", fontsize=10)
    return figure


def meshes_figure(meshes: dict[str, VoronoiMesh]) -> Figure:
    """Each mesh coloured by the width of its cells, on the globe and seen from outside."""
    figure = Figure(figsize=(11.0, 3.6 * len(meshes)), layout="constrained")
    panels = figure.subplots(len(meshes), 2, width_ratios=[2.0, 1.0], squeeze=False)
    for (wide, round_), (title, mesh) in zip(panels, meshes.items(), strict=True):
        width = np.degrees(np.sqrt(mesh.area_cell))
        draw_mollweide(wide, mesh, width, {"cmap": "viridis"})
        drawn = draw_orthographic(round_, mesh, width, {"cmap": "viridis"}).collections[-1]
        drawn.set(edgecolor="white", linewidth=0.2)
        figure.colorbar(drawn, ax=[wide, round_], label="root of cell area (degrees)", shrink=0.8)
        wide.set_title(title)
    return figure


def sizes_figure(meshes: dict[str, VoronoiMesh]) -> Figure:
    """Mean neighbour distance and area of each cell against its rank, as in the paper's figures against cell number."""
    figure = Figure(figsize=(11.0, 4.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    for title, mesh in meshes.items():
        inside = mesh.on_ring
        distances = np.where(inside, mesh.dc_edge[np.where(inside, mesh.edges_on_cell, 0)], 0.0)
        size = np.degrees(distances.sum(axis=1) / mesh.n_edges_on_cell)
        rank = np.arange(mesh.n_cells) / mesh.n_cells
        left.plot(rank, np.sort(size), label=title)
        right.plot(rank, np.sort(mesh.area_cell) * mesh.n_cells / (4.0 * np.pi), label=title)
    left.set_ylabel("mean distance to the neighbours (degrees)")
    right.set_ylabel("area over the mean area")
    for axes in (left, right):
        axes.set_xlabel("cell number, by size, over number of cells")
        axes.grid(alpha=0.3)
    left.legend(fontsize=8)
    return figure


def starts_lines(meshes: list[Start]) -> list[str]:
    """Meshes over starts in Markdown."""
    lines = [
        "| start | seed | "
        + " | ".join(QUALITY_LABELS)
        + " | obtuse | residual | iterations | energy | dislocations |",
        "|---|---|" + "---|" * (len(QUALITY_LABELS) + 5),
    ]
    for mesh in meshes:
        values = " | ".join(f"{getattr(mesh.quality, name):.4f}" for name in QUALITY_MEASURES)
        lines.append(
            f"| {mesh.start} | {mesh.seed} | {values} | {mesh.quality.obtuse} | {mesh.quality.residual:.1e} | "
            f"{mesh.history.iterations} | {mesh.history.energy[-1]:.6e} | {mesh.dislocations} |"
        )
    return lines
