"""The description of a mesh to be generated, with the defaults of everything that may be left out.

This module imports no package when it runs, so that the command line can read the defaults quickly.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from mesh.arrays import Array
    from mesh.shown import Rows
    from mesh.voronoi_mesh import VoronoiMesh


@dataclass(frozen=True, repr=False)
class MeshRequest:
    """A mesh to be generated; `scvt_mesh`, but for those of planes, and `trisk mesh` take its fields by the same names.

    `mesh_on_plane` and `region_mesh` take the request as it is.

    Attributes
    ----------
    cells
        Number of cells; a `nested` mesh may leave it to the density.
    density
        A name, the name of a NetCDF file, or any callable (see `mesh.density.named`, on planes `mesh.density.planar`).
    start
        Starting points (see `mesh.generation.generators.starting_points`); by default from the bisected
        icosahedron where that has this number of cells, else from the Fibonacci spiral; `lbfgs` under a density refines
        a converged mesh of a quarter as many cells, and so on down. On a plane see `mesh.plane.starts`.
    method
        `lbfgs`, `lloyd`, `multilevel` (L-BFGS on icosahedral meshes from coarse to fine), `probabilistic` or
        `macqueen`.
    tolerance
        Largest distance of a generator from the centroid of its cell, in mean spacings; by default as small as the
        density and the method allow.
    max_iterations
        Iterations after which each optimisation gives up.
    seed
        Seed of all random choices.
    nested
        A mesh to refine where the density asks for it, in place of a start; all other generators stay.
    well_centered
        Whether to trade a little centroidality for a mesh without obtuse triangles.
    max_seconds
        Seconds after which the generation gives up.
    density_variable
        Variable of a density file.
    density_floor, density_power, density_smoothing
        What is done to the field of a density file (see `mesh.density.gridded.Shaping`).
    plane
        Lengths along x and y, metres, of a plane in place of the sphere.
    periodic
        Directions in which the plane repeats itself: "xy", "x", or "none"; walls stand at the other ends.
    hexagons
        Numbers along x and y of the regular hexagons of the plane (see `mesh.plane.hexagons.hexagon_mesh`), with which
        nothing else goes.
    """

    cells: int | None = None
    density: str | os.PathLike[str] | Callable[[Array], Array] = "uniform"
    start: str | None = None
    method: str = "lbfgs"
    tolerance: float | None = None
    max_iterations: int = 10_000
    seed: int = 0
    nested: VoronoiMesh | None = None
    well_centered: bool = False
    max_seconds: float = float("inf")
    density_variable: str = "density"
    density_floor: float = 0.0
    density_power: float = 1.0
    density_smoothing: int = 0
    plane: tuple[float, float] | None = None
    periodic: str = "xy"
    hexagons: tuple[int, int] | None = None

    def _title_and_rows(self) -> tuple[str, Rows]:
        """Cells, density and method, and of all others those that are not the default."""
        from mesh.shown import in_words
        from mesh.voronoi_mesh import mesh_in_words

        rows = {name: in_words(getattr(self, name)) for name in ("density", "method")}
        for each in fields(self):
            value = getattr(self, each.name)
            if each.name not in ("cells", "nested") and repr(value) != repr(each.default):
                rows[each.name.replace("_", " ")] = in_words(value)
        if self.nested is not None:
            rows["nested"] = f"in a mesh of {mesh_in_words(self.nested)}"
        cells = "as many cells as the density asks for" if self.cells is None else f"{in_words(self.cells)} cells"
        return f"MeshRequest for {cells}", rows

    # `mesh.shown.Shown` is no base of this class, as the command line reads this module without its package.

    def __repr__(self) -> str:
        from mesh.shown import as_text

        return as_text(*self._title_and_rows())

    def _repr_html_(self) -> str:
        from mesh.shown import as_html

        return as_html(*self._title_and_rows())
