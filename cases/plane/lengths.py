"""Which planes a case can be run on: where they must repeat themselves, and after which lengths."""

from cases.plane.base import PlaneCase
from mesh.voronoi_mesh import VoronoiMesh
from swe.errors import InputError

FIT = 1e-6
"""Relative difference by which a period of the mesh may miss whole lengths of the case."""


def require_periodic(case: PlaneCase, mesh: VoronoiMesh) -> None:
    """Raise `InputError` unless the plane is periodic in the directions of the case, and in no other."""
    found = "".join(axis for axis in "xy" if getattr(mesh, f"{axis}_period") > 0.0) or "none"
    if found != case.periodic:
        raise InputError(
            f"{case.name} needs a mesh on a plane with --periodic {case.periodic}, and this one has --periodic "
            f"{found}; take another mesh (trisk mesh --plane)"
        )


def require_periods(case: PlaneCase, mesh: VoronoiMesh, **lengths: float) -> None:
    """Raise `InputError` unless the plane repeats itself as that of the case, after whole `lengths`, m.

    Each is the parameter of the case called x_length or y_length.
    """
    require_periodic(case, mesh)
    for axis, length in lengths.items():
        period = getattr(mesh, f"{axis}_period")
        repeats = period / length
        if not (repeats > 0.5 and abs(repeats - round(repeats)) <= FIT * repeats):
            raise InputError(
                f"{case.name} repeats itself after {axis}_length = {length:.10g} m, but the mesh after "
                f"{period:.10g} m in {axis}; set {axis}_length, or take another mesh"
            )
