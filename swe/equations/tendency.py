"""The tendency of the energy-conserving schemes, written like its equations, with sparse operators.

This is the plain statement of the schemes; the kernels of `swe.equations` and `swe.tiles` compute the same and are
tested against it. The bracket is one; the schemes differ in the kinetic energy K, and in the mass flux F that goes with
it.
"""

from collections.abc import Callable

from mesh.arrays import Array
from mesh.discrete.operators import Operators
from swe.state import State

Energy = Callable[[Operators, Array, Array], tuple[Array, Array]]
"""Gives K at cells, m2/s2, and F at edges, m2/s, from thickness and normal velocity; see `ringler2010`."""


def ringler2010(operators: Operators, h: Array, u: Array) -> tuple[Array, Array]:
    """K and F of Thuburn et al. (2009) and Ringler et al. (2010), equations (49) and (63)."""
    return operators.kinetic_energy @ u**2, (operators.cell_to_edge @ h) * u


def consistent(operators: Operators, h: Array, u: Array) -> tuple[Array, Array]:
    """K and F of `swe.equations.consistent`; arrays (n_cells, max_edges, ...) hold what belongs to sides of cells."""
    mesh, sides = operators.mesh, operators.sides
    n, r, d = sides.normal, sides.middle, sides.distance
    l_e = mesh.dv_edge[mesh.edges_on_cell]
    A = mesh.area_cell[:, None]
    w = l_e * d / (2.0 * A)
    out = (operators.outward @ u).reshape(d.shape)
    v = ((l_e * out)[..., None] * r).sum(axis=1) / A
    left = out - (n @ v[..., None])[..., 0]
    y = v - ((w * left)[..., None] * n).sum(axis=1)
    K = 0.5 * (v**2).sum(axis=1) + 0.5 * (w * left**2).sum(axis=1)
    part = h[:, None] * (0.5 * left + (r @ y[..., None])[..., 0] / d)
    return K, operators.outward.T @ part.ravel()


def tendency(
    state: State,
    operators: Operators,
    topography: Array,
    coriolis: Array,
    gravity: float,
    energy: Energy = ringler2010,
) -> State:
    """Time derivative of thickness at cells, m/s, and of normal velocity at edges, m/s2.

    `topography` (n_cells,), m; `coriolis` parameter (n_vertices,), 1/s;
    `gravity`, m/s2. Ringler et al. (2010), equations (19), (20) and (49).
    """
    h, u, b, f, g = state.thickness, state.normal_velocity, topography, coriolis, gravity
    K, F = energy(operators, h, u)
    zeta = operators.curl @ u
    q = (f + zeta) / (operators.cell_to_vertex @ h)
    q_edge = operators.vertex_to_edge @ q
    Q = 0.5 * (q_edge * (operators.perp @ F) + operators.perp @ (q_edge * F))
    return State(
        thickness=-(operators.divergence @ F),
        normal_velocity=Q - operators.gradient @ (g * (h + b) + K),
    )
