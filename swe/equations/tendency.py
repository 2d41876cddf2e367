"""The tendency of the energy-conserving scheme, written like its equations, with sparse operators.

This is the plain statement of the scheme of Thuburn et al. (2009) and Ringler et al. (2010); the kernels of
`swe.equations.kernels` compute the same and are tested against it.
"""

from mesh.arrays import Array
from mesh.discrete.operators import Operators
from swe.state import State


def tendency(state: State, operators: Operators, topography: Array, coriolis: Array, gravity: float) -> State:
    """Time derivative of thickness at cells, m/s, and of normal velocity at edges, m/s2.

    `topography` (n_cells,), m; `coriolis` parameter (n_vertices,), 1/s; `gravity`, m/s2. Ringler et al. (2010),
    equations (19), (20) and (49).
    """
    h, u, b, f, g = state.thickness, state.normal_velocity, topography, coriolis, gravity
    F = (operators.cell_to_edge @ h) * u
    zeta = operators.curl @ u
    q = (f + zeta) / (operators.cell_to_vertex @ h)
    q_edge = operators.vertex_to_edge @ q
    Q = 0.5 * (q_edge * (operators.perp @ F) + operators.perp @ (q_edge * F))
    K = operators.kinetic_energy @ u**2
    return State(
        thickness=-(operators.divergence @ F),
        normal_velocity=Q - operators.gradient @ (g * (h + b) + K),
    )
