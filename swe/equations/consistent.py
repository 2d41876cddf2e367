"""The scheme whose kinetic energy is exact for uniform flow, whatever the shape of the cells.

In the tangent plane of cell i, with s the sign of u on side e outward, n the unit vector towards the neighbour, r the
vector to the middle of the Voronoi edge and w = l d / (2 A),

    v = 1/A sum l s u r                                     the velocity of the cell, Perot (2000)
    K = 1/2 |v|^2 + 1/2 sum w (s u - n.v)^2                 its energy, and that of what v leaves over
    F = sum over both cells of h s [1/2 (s u - n.v) + r.y/d],   y = v - sum w (s u - n.v) n

On regular hexagons this is K and F of Ringler et al. (2010). `docs/scheme.md` derives it and names its relatives.
"""

import numba
import numpy as np

from mesh.arrays import Array, Index, Signs
from mesh.discrete.sides import sides_of_cells
from mesh.voronoi_mesh import VoronoiMesh
from swe.equations.schemes import Scheme

inlined = numba.njit(error_model="numpy", fastmath={"contract"}, forceinline=True)
compiled = numba.njit(cache=True, parallel=True, error_model="numpy", fastmath={"contract"})


class Consistent(Scheme):
    """Kinetic energy exact for uniform flow, and the flux that belongs to it."""

    name = "consistent"
    source = "as Thuburn et al. (2009) and Ringler et al. (2010), with kinetic energy exact for uniform flow"
    rings = 3  # the flux at the sides of a neighbour has a part from cells beyond, of all their sides

    def __init__(self, mesh: VoronoiMesh) -> None:
        super().__init__(mesh)
        self.sides = sides = sides_of_cells(mesh)
        signs = mesh.edge_signs_on_cell
        mesh = self.mesh
        self._on_cells = (
            *(mesh.n_edges_on_cell, mesh.edges_on_cell, signs, mesh.dc_edge, mesh.dv_edge, mesh.area_cell),
            *(sides.normal, sides.middle),
        )
        place = mesh.edges_on_cell[mesh.cells_on_edge] == np.arange(mesh.n_edges)[:, None, None]
        self._side_on_edge = np.argmax(place, axis=2).astype(np.int8)
        self._velocity, self._remainder = np.empty((mesh.n_cells, 2)), np.empty((mesh.n_cells, 2))

    def kinetic_energy(self, u: Array, K: Array) -> None:
        """See `swe.equations.schemes.Scheme`."""
        _kinetic_energy(u, *self._on_cells, K)

    def flux(self, h: Array, u: Array, F: Array) -> None:
        """See `swe.equations.schemes.Scheme`."""
        _, _, signs, lengths, _, _, normals, middles = self._on_cells
        _velocities(u, *self._on_cells, self._velocity, self._remainder)
        _flux(
            *(h, u, self._velocity, self._remainder, self.mesh.cells_on_edge, self._side_on_edge),
            *(signs, normals, middles, lengths, F),
        )


@inlined
def _velocity(
    i: int, u: Array, sides: int, edges: Index, sign: Signs, l_e: Array, area: float, middle: Array
) -> tuple[float, float]:
    """The velocity v of cell i."""
    v_0 = v_1 = 0.0
    for j in range(sides):
        outflow = l_e[edges[i, j]] * sign[i, j] * u[edges[i, j]]
        v_0 += outflow * middle[i, j, 0]
        v_1 += outflow * middle[i, j, 1]
    return v_0 / area, v_1 / area


@compiled
def _kinetic_energy(
    u: Array,
    n_edges_on_cell: Index,
    edges: Index,
    sign: Signs,
    d: Array,
    l_e: Array,
    area: Array,
    normal: Array,
    middle: Array,
    K: Array,
) -> None:
    """K at cells."""
    for i in numba.prange(K.size):
        v_0, v_1 = _velocity(i, u, n_edges_on_cell[i], edges, sign, l_e, area[i], middle)
        energy = 0.0
        for j in range(n_edges_on_cell[i]):
            e = edges[i, j]
            left = sign[i, j] * u[e] - (normal[i, j, 0] * v_0 + normal[i, j, 1] * v_1)
            energy += l_e[e] * d[e] * left * left
        K[i] = 0.5 * (v_0 * v_0 + v_1 * v_1) + 0.25 * energy / area[i]


@compiled
def _velocities(
    u: Array,
    n_edges_on_cell: Index,
    edges: Index,
    sign: Signs,
    d: Array,
    l_e: Array,
    area: Array,
    normal: Array,
    middle: Array,
    v: Array,
    y: Array,
) -> None:
    """The vectors v and y at cells (n_cells, 2)."""
    for i in numba.prange(area.size):
        v_0, v_1 = _velocity(i, u, n_edges_on_cell[i], edges, sign, l_e, area[i], middle)
        left_0 = left_1 = 0.0
        for j in range(n_edges_on_cell[i]):
            e = edges[i, j]
            left = sign[i, j] * u[e] - (normal[i, j, 0] * v_0 + normal[i, j, 1] * v_1)
            left_0 += l_e[e] * d[e] * left * normal[i, j, 0]
            left_1 += l_e[e] * d[e] * left * normal[i, j, 1]
        v[i, 0], v[i, 1] = v_0, v_1
        y[i, 0], y[i, 1] = v_0 - 0.5 * left_0 / area[i], v_1 - 0.5 * left_1 / area[i]


@compiled
def _flux(
    h: Array,
    u: Array,
    v: Array,
    y: Array,
    cells_on_edge: Index,
    side_on_edge: Signs,
    sign: Signs,
    normal: Array,
    middle: Array,
    d: Array,
    F: Array,
) -> None:
    """F at edges, the sum over both cells."""
    for e in numba.prange(F.size):
        flux = 0.0
        for k in range(2):
            i, j = cells_on_edge[e, k], side_on_edge[e, k]
            along = normal[i, j, 0] * v[i, 0] + normal[i, j, 1] * v[i, 1]
            across = (middle[i, j, 0] * y[i, 0] + middle[i, j, 1] * y[i, 1]) / d[e]
            flux += h[i] * sign[i, j] * (0.5 * (sign[i, j] * u[e] - along) + across)
        F[e] = flux
