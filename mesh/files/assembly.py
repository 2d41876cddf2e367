"""A mesh from the content of its file: sorted into our order, and rebuilt where no information is lost."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array
from mesh.conventions import BY_NAME
from mesh.discrete.comparison import angle_difference, angles_in_place, metric_differences
from mesh.discrete.metrics import compute_metrics
from mesh.discrete.validate import OUTSIDE_TOLERANCE, check_values, require_on_sphere, require_small
from mesh.discrete.walls import has_walls
from mesh.errors import MeshError, require
from mesh.files.arrange import arrange_kites, arrange_weights, arranged_topology, reordered, topology_in_order
from mesh.files.at_walls import at_walls_in, vertex_points
from mesh.files.mesh_file import SPARE, FileContent, fill_rings, positive_number
from mesh.files.sea_order import arrange_sea_weights, arranged_sea, has_walls_in
from mesh.geometry.angles import TURN, eastward
from mesh.geometry.sphere import dot, from_lonlat
from mesh.geometry.surface import UNIT_SPHERE, Surface, surface_of
from mesh.voronoi_mesh import METRICS_NAMES, TOPOLOGY_NAMES, Metrics, Topology, VoronoiMesh

GENERATORS = ("x_cell", "y_cell", "z_cell")
ROUNDING_GROWTH = 20.0
"""How many times larger than the rounding of generators the displacement of a circumcentre may be."""

MOST_LISTED = 6
"""Arrays that a warning names."""

ON_EDGES = tuple(name for name, variable in BY_NAME.items() if "n_edges" in (variable.dimensions[0], variable.of))
"""Arrays that mean something only where the edges have the numbers of the file."""


@dataclass
class FileChanges:
    """What was changed in the content of a file, in words."""

    said: list[str] = field(default_factory=list)
    sorted: list[str] = field(default_factory=list)
    missing: list[str] = field(default_factory=list)
    replaced: list[str] = field(default_factory=list)

    @property
    def in_words(self) -> str:
        """One line, empty if nothing was changed."""
        parts = list(self.said)
        if self.sorted:
            parts.append(f"sorted {_listed(self.sorted)}")
        if self.missing:
            parts.append(f"made {_listed(self.missing)}, which the file lacks, from the generators and triangles")
        if self.replaced:
            parts.append(f"replaced {_listed(self.replaced)} by what the generators give")
        return "; ".join(parts)


def assembled_mesh(content: FileContent, recompute_metrics: bool) -> tuple[VoronoiMesh, FileChanges]:
    """The mesh of a file, not yet validated for its identities, and what was changed on the way.

    Needed are generators and triangles. Raises `MeshError` where they are missing, where connectivity contradicts
    itself, or where metrics that the solver uses are not those of the generators.
    """
    arrays, changes = dict(content.arrays), FileChanges()
    fill_rings(arrays)
    surface, (x_period, y_period) = content.surface, content.periods or (0.0, 0.0)
    if content.on_a_sphere:
        points, radius = _generators(arrays, content.radius, changes)
    else:
        points, radius = _generators_on_plane(arrays, surface), 0.0
    topology = _topology(arrays, points, changes, surface)
    at_walls = None
    if has_walls(topology):
        at_walls = at_walls_in(arrays, topology, points, radius or 1.0, changes.replaced, surface)
    exact = compute_metrics(points, topology, at_walls, surface)
    density = _density(arrays, len(points), changes)
    topology_arrays = {name: getattr(topology, name) for name in TOPOLOGY_NAMES}
    unit = VoronoiMesh(
        **topology_arrays,
        **{name: getattr(exact, name) for name in METRICS_NAMES},
        mesh_density=density,
        sphere_radius=1.0 if content.on_a_sphere else 0.0,
        x_period=x_period,
        y_period=y_period,
    )
    rebuilt = unit.scaled(radius)
    if recompute_metrics:
        return rebuilt, changes
    metrics = _metrics_of_file(arrays, topology, exact)
    if content.single_precision:
        _require_metrics_but_for_rounding(replace(rebuilt, **metrics), exact)  # type: ignore[arg-type]
        changes.said.append("coordinates are in single precision, so that all metrics are taken from them")
        return rebuilt, changes
    return _with_metrics_of_file(rebuilt, exact, metrics, changes), changes


def _generators(arrays: dict[str, NDArray], attribute: object, changes: FileChanges) -> tuple[Array, float]:
    """Unit vectors (n_cells, 3) of the generators, and the radius of the sphere."""
    if all(name in arrays for name in GENERATORS):
        points = np.stack([arrays[name] for name in GENERATORS], axis=1)
        for name in GENERATORS:
            require(np.isfinite(arrays[name]), "cells", f"{BY_NAME[name].file_name} is not a finite number")
        distance = np.sqrt(dot(points, points))
        radius = positive_number(attribute)
        if radius is None or np.any(np.abs(distance / radius - 1.0) > OUTSIDE_TOLERANCE):
            radius = _radius_of(points, distance, attribute, changes)
        return UNIT_SPHERE.kept_on(points), radius
    if not all(name in arrays for name in ("lon_cell", "lat_cell")):
        raise MeshError(
            "xCell, yCell and zCell are missing, and lonCell and latCell too; a mesh file must have its generators"
        )
    longitude, latitude = arrays["lon_cell"], arrays["lat_cell"]
    require(np.isfinite(longitude), "cells", "lonCell is not a finite number")
    require(np.isfinite(latitude), "cells", "latCell is not a finite number")
    require(np.abs(latitude) <= 0.5 * np.pi + OUTSIDE_TOLERANCE, "cells", "latCell is beyond a pole (radians)")
    radius = positive_number(attribute)
    if radius is None:
        radius = 1.0
        changes.said.append("without a sphere_radius the sphere is taken to have radius 1")
    return from_lonlat(longitude, latitude), radius


def _generators_on_plane(arrays: dict[str, NDArray], surface: Surface) -> Array:
    """The generators (n_cells, 3), metres; z is zero where the file has none."""
    if not all(name in arrays for name in GENERATORS[:2]):
        raise MeshError("xCell and yCell are missing; the file of a mesh on a plane must have its generators")
    arrays.setdefault("z_cell", np.zeros_like(arrays["x_cell"]))
    for name in GENERATORS:
        require(np.isfinite(arrays[name]), "cells", f"{BY_NAME[name].file_name} is not a finite number")
    points = np.stack([arrays[name] for name in GENERATORS], axis=1)
    require(~surface.is_off(points, 1.0, OUTSIDE_TOLERANCE), "cells", "on_a_sphere is NO, but zCell is not zero")
    if not (surface.handles or has_walls_in(arrays)):
        raise MeshError(
            "the mesh has no walls, but its plane is not periodic in both directions (is_periodic, x_period, y_period)"
        )
    return points


def _radius_of(points: Array, distance: Array, attribute: object, changes: FileChanges) -> float:
    """The radius of the sphere that the generators lie on, whatever the attribute says."""
    radius = float(np.median(distance))
    if not radius > 0.0:
        raise MeshError("xCell, yCell and zCell are zero; a mesh file must have its generators")
    require_on_sphere(points, radius, "cells")
    # Rounding of the coordinates is no radius of its own.
    radius = 1.0 if abs(radius - 1.0) <= OUTSIDE_TOLERANCE else float(f"{radius:.10g}")
    stated = "missing" if attribute is None else str(attribute)
    changes.said.append(
        f"the attribute sphere_radius is {stated}, but the coordinates lie at {radius:.10g}, which is used"
    )
    return radius


def _topology(arrays: dict[str, NDArray], points: Array, changes: FileChanges, surface: Surface) -> Topology:
    """Connectivity in our order; `arrays` loses what means nothing without the numbers of the edges."""
    if "cells_on_vertex" not in arrays:
        raise MeshError(
            "the variable cellsOnVertex is missing; a mesh file must have its triangles (mesh_from_points makes a mesh "
            "of generators alone)"
        )
    walls = has_walls_in(arrays)
    at_boundary = (
        arrays["cells_on_vertex"].min(axis=1) < 0 if walls else np.zeros(len(arrays["cells_on_vertex"]))
    ).astype(np.int32)
    boundary = arrays.pop("boundary_vertex", None)
    if boundary is not None and np.any(boundary != at_boundary):
        changes.replaced.append("boundaryVertex" if walls else f"boundaryVertex (a closed {surface.name} has none)")
    if "cells_on_edge" not in arrays:
        for name in ON_EDGES:
            arrays.pop(name, None)
    missing = [name for name in TOPOLOGY_NAMES if name != "boundary_vertex" and name not in arrays]
    if missing:
        changes.missing.extend(BY_NAME[name].file_name for name in missing)
    topology = topology_in_order({**arrays, "boundary_vertex": at_boundary}, points, surface)
    if topology is None:
        topology = (
            arranged_sea(arrays, points, vertex_points(arrays, surface), surface)
            if walls
            else arranged_topology(arrays, points, surface)
        )
        changes.sorted.extend(reordered(arrays, topology))
    return topology


def _density(arrays: dict[str, NDArray], n_cells: int, changes: FileChanges) -> Array:
    """The density at the generators; one everywhere if the file has none."""
    density = arrays.get("mesh_density")
    if density is None:
        return np.ones(n_cells)
    if not np.isfinite(density).all():
        changes.said.append("meshDensity is not finite everywhere and taken to be 1")
        return np.ones(n_cells)
    return density


def _metrics_of_file(arrays: dict[str, NDArray], topology: Topology, exact: Metrics) -> dict[str, NDArray]:
    """The metrics that the file has, in the order of the topology."""
    metrics = {name: arrays[name] for name in METRICS_NAMES if name in arrays}
    if "kite_areas_on_vertex" in metrics and not np.array_equal(arrays["cells_on_vertex"], topology.cells_on_vertex):
        metrics["kite_areas_on_vertex"] = arrange_kites(
            metrics["kite_areas_on_vertex"], arrays["cells_on_vertex"], topology
        )
    if "weights_on_edge" in metrics:
        if "edges_on_edge" not in arrays:
            del metrics["weights_on_edge"]
        elif not _lists_the_same_edges(arrays, topology):
            arrange = arrange_sea_weights if has_walls(topology) else arrange_weights
            metrics["weights_on_edge"] = arrange(metrics["weights_on_edge"], arrays, topology, exact.weights_on_edge)
    for place in ("cell", "edge", "vertex"):
        longitude = metrics.get(f"lon_{place}")
        if longitude is not None and not np.all((longitude >= 0.0) & (longitude < TURN)):
            metrics[f"lon_{place}"] = eastward(longitude)
    return metrics


def _lists_the_same_edges(arrays: dict[str, NDArray], topology: Topology) -> bool:
    """Whether the edges of tangents are those of the topology, in the same order and as many."""
    names = ("edges_on_edge", "n_edges_on_edge")
    return all(np.array_equal(arrays[name], getattr(topology, name)) for name in names if name in arrays)


def _require_metrics_but_for_rounding(mesh: VoronoiMesh, exact: Metrics) -> None:
    """Raise `MeshError` where metrics differ by more than the rounding of coordinates to single precision explains."""
    extent = float(surface_of(mesh).extent(mesh.cell_points))
    rounding = ROUNDING_GROWTH * float(np.finfo(np.float32).eps) * extent / float(exact.dc_edge.min())
    for difference in metric_differences(mesh, exact):
        if not SPARE.issuperset(difference.names):
            require_small(difference, OUTSIDE_TOLERANCE + rounding)


def _with_metrics_of_file(
    rebuilt: VoronoiMesh, exact: Metrics, metrics: dict[str, NDArray], changes: FileChanges
) -> VoronoiMesh:
    """`rebuilt` with the metrics of the file, except for wrong ones that no time step depends on."""
    changes.missing.extend(BY_NAME[name].file_name for name in METRICS_NAMES if name not in metrics)
    mesh = replace(rebuilt, **metrics)  # type: ignore[arg-type]
    for difference in metric_differences(mesh, exact):
        if not SPARE.issuperset(difference.names):
            require_small(difference)
        elif np.any(difference.relative > OUTSIDE_TOLERANCE):
            changes.replaced.append(f"{difference.label} (differed by up to {difference.in_words})")
            mesh = replace(mesh, **{name: getattr(rebuilt, name) for name in difference.names})
    angle = angle_difference(mesh, exact)
    if np.any(angle.relative > OUTSIDE_TOLERANCE):
        if "angle_edge" in metrics:
            changes.replaced.append(f"{angle.label} (differed by up to {angle.in_words})")
        mesh = replace(mesh, angle_edge=angles_in_place(mesh, exact))
    check_values(mesh)
    return mesh


def _listed(names: list[str]) -> str:
    if len(names) > MOST_LISTED:
        return f"{', '.join(names[:MOST_LISTED])} and {len(names) - MOST_LISTED} more"
    return ", ".join(names)
