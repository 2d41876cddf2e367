"""A smooth flow on the unit sphere, known exactly, for truncation errors.

It is that of test case 6 of Williamson et al. (1992) with a divergent part:

    psi = -z + z Re (x + iy)^4        chi = 2 x y z        u = k x grad(psi) + grad(chi)

All terms are spherical harmonics, so that vorticity and divergence are psi and chi times -n (n + 1), and there is no
trouble at the poles.
"""

import numpy as np

from mesh.arrays import Array
from mesh.geometry.sphere import dot


class SphereFlow:
    """The flow as functions of unit vectors (n, 3)."""

    def streamfunction(self, points: Array) -> Array:
        """Streamfunction psi at unit vectors (n, 3)."""
        x, y, z = points.T
        return -z + z * _wave(x, y)

    def streamfunction_gradient(self, points: Array) -> Array:
        """Gradient (n, 3) of psi along the sphere at unit vectors (n, 3)."""
        x, y, z = points.T
        slope = np.stack(
            [4.0 * z * (x**3 - 3.0 * x * y**2), 4.0 * z * (y**3 - 3.0 * x**2 * y), _wave(x, y) - 1.0], axis=1
        )
        return _tangential(slope, points)

    def velocity(self, points: Array) -> Array:
        """Velocity (n, 3) at unit vectors (n, 3), tangential to the sphere."""
        x, y, z = points.T
        divergent = _tangential(2.0 * np.stack([y * z, x * z, x * y], axis=1), points)
        return np.cross(points, self.streamfunction_gradient(points)) + divergent

    def vorticity(self, points: Array) -> Array:
        """Relative vorticity at unit vectors (n, 3): -z has degree 1, the wave degree 5."""
        x, y, z = points.T
        return 2.0 * z - 30.0 * z * _wave(x, y)

    def divergence(self, points: Array) -> Array:
        """Divergence at unit vectors (n, 3): the potential has degree 3."""
        x, y, z = points.T
        return -24.0 * x * y * z


def _wave(x: Array, y: Array) -> Array:
    """Real part of (x + iy)^4, which is cos(lat)^4 cos(4 lon)."""
    return x**4 - 6.0 * x**2 * y**2 + y**4


def _tangential(vectors: Array, points: Array) -> Array:
    """Vectors without their radial part."""
    return vectors - dot(vectors, points)[:, None] * points
