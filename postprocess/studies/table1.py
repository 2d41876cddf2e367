"""Table 1 of Ju, Ringler and Gunzburger (2011) made anew: quality of icosahedral meshes, ours beside the published."""

from collections.abc import Callable
from dataclasses import dataclass

from mesh.discrete.build import mesh_from_points
from mesh.discrete.quality import Quality, mesh_quality
from mesh.generation.generators import icosahedral_mesh
from mesh.generation.scvt import generate_scvt
from mesh.mesh_request import MeshRequest
from mesh.triangulation.ordering import renumber
from swe.errors import InputError

Measures = tuple[float, float, float, float, float]
QUALITY_MEASURES = ("mu", "sigma_avg", "sigma_min", "q_avg", "q_min")
QUALITY_LABELS = ("μ", "σ avg", "σ min", "q avg", "q min")

FIRST_LEVEL = 2

UNIFORM_TOLERANCE = 1e-6
"""Residual, in mean spacings, of the SCVTs of the table: what digits it shows do not change any more."""

PUBLISHED_BISECTION: dict[int, Measures] = {
    2: (1.1308, 0.9174, 0.8843, 0.9872, 0.9829),
    3: (1.1777, 0.9111, 0.8586, 0.9904, 0.9729),
    4: (1.1907, 0.8737, 0.8482, 0.9865, 0.9701),
    5: (1.1940, 0.8803, 0.8405, 0.9866, 0.9694),
    6: (1.1948, 0.8879, 0.8386, 0.9866, 0.9692),
    7: (1.1951, 0.8932, 0.8380, 0.9866, 0.9692),
    8: (1.1951, 0.8966, 0.8379, 0.9870, 0.9692),
    9: (1.1952, 0.8970, 0.8378, 0.9952, 0.9691),
}
"""As printed. Row 3 is shifted: its sigma and q are those of the SCVT; q_avg of rows 8 and 9 cannot be."""

PUBLISHED_SCVT: dict[int, Measures] = {
    2: (1.1308, 0.9174, 0.8843, 0.9872, 0.9829),
    3: (1.1647, 0.9174, 0.8843, 0.9872, 0.9829),
    4: (1.1592, 0.9121, 0.8525, 0.9923, 0.9701),
    5: (1.2335, 0.9141, 0.8511, 0.9931, 0.9694),
    6: (1.2710, 0.9157, 0.8507, 0.9934, 0.9692),
    7: (1.3107, 0.9168, 0.8504, 0.9935, 0.9692),
    8: (1.3526, 0.9173, 0.8494, 0.9952, 0.9687),
    9: (1.4080, 0.9167, 0.8465, 0.9987, 0.9675),
}
"""As printed. Row 3 repeats row 2; mu of row 4 breaks the sequence; from row 7 on mu tells of unconverged meshes."""


@dataclass(frozen=True)
class Row:
    """One level: our bisection and SCVT, and how long the SCVT took."""

    level: int
    bisection: Quality
    scvt: Quality
    iterations: int
    seconds: float


def table1(max_level: int, tolerance: float, tell: Callable[[Row], None] | None = None) -> list[Row]:
    """Rows for levels 2 to `max_level` (10*4^(level-1)+2 cells), SCVTs converged to `tolerance` mean spacings.

    `tell` is called with each row as it is made. Raises `InputError` for a level that the table does not have.
    """
    if not FIRST_LEVEL <= max_level <= max(PUBLISHED_SCVT):
        raise InputError(f"level {max_level} is not in Table 1; choose one from {FIRST_LEVEL} to {max(PUBLISHED_SCVT)}")
    rows = []
    for level in range(FIRST_LEVEL, max_level + 1):
        bisection = mesh_quality(mesh_from_points(*renumber(*icosahedral_mesh(level - 1))))
        result = generate_scvt(MeshRequest(bisection.cells, tolerance=tolerance))
        quality = mesh_quality(mesh_from_points(result.points, result.triangles))
        rows.append(Row(level, bisection, quality, result.history.iterations, result.history.seconds[-1]))
        if tell is not None:
            tell(rows[-1])
    return rows


def measures(quality: Quality) -> Measures:
    """The five `QUALITY_MEASURES` of the table."""
    return quality.mu, quality.sigma_avg, quality.sigma_min, quality.q_avg, quality.q_min
