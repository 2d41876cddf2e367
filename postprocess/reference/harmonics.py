"""Spherical harmonics on a Gauss-Legendre grid and at any points, by ducc0 (the extra `reference`).

Coefficients are those of orthonormal harmonics for orders m >= 0 of a real field, (n_coefficients,) complex: all
degrees of order 0, then those of order 1, and so on. Grid fields are (n_latitudes, n_longitudes) from north to
south and from longitude 0 to the east.
"""

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from mesh.arrays import Array, Index
from mesh.geometry.angles import eastward
from swe.errors import InputError

try:
    import ducc0
except ImportError as missing:
    raise InputError(
        "spherical harmonics need the package ducc0; install it with pip install 'trisk[reference]'"
    ) from missing

Coefficients = NDArray[np.complex128]

POINT_ACCURACY = 1e-12
"""Relative accuracy of values at scattered points; ducc0 gets there by non-uniform fast Fourier transforms."""


class Harmonics:
    """Transforms up to total wavenumber `truncation` on a sphere of `radius` metres.

    The grid is the smallest on which products of two fields are free of aliasing, or `oversampling` times as fine.
    """

    def __init__(self, truncation: int, radius: float, oversampling: int = 1) -> None:
        self.truncation = truncation
        self.radius = radius
        self.n_latitudes = oversampling * (3 * truncation // 2 + 1)
        self.n_longitudes = int(ducc0.fft.good_size(oversampling * (3 * truncation + 1)))
        self.degree = degrees(truncation)
        self._root = np.sqrt(self.degree * (self.degree + 1.0)) / radius
        self._inverse_root = np.where(self.degree > 0, 1.0, 0.0) / np.where(self.degree > 0, self._root, 1.0)
        self._options = {"lmax": truncation, "geometry": "GL"}
        self._size = {"ntheta": self.n_latitudes, "nphi": self.n_longitudes}

    @property
    def laplacian(self) -> Array:
        """Eigenvalue of the Laplacian for every coefficient, 1/m2."""
        return -(self._root**2)

    @cached_property
    def points(self) -> tuple[Array, Array]:
        """Longitudes and latitudes of the grid, each (n_latitudes, n_longitudes), rad."""
        longitude = 2.0 * np.pi * np.arange(self.n_longitudes) / self.n_longitudes
        latitude = np.arcsin(np.polynomial.legendre.leggauss(self.n_latitudes)[0][::-1])
        longitudes, latitudes = np.meshgrid(longitude, latitude)
        return longitudes, latitudes

    def to_grid(self, coefficients: Coefficients) -> Array:
        """Values of a scalar field on the grid."""
        field: Array = ducc0.sht.synthesis_2d(alm=coefficients[None, :], spin=0, **self._options, **self._size)[0]
        return field

    def from_grid(self, field: Array) -> Coefficients:
        """Coefficients of a scalar field."""
        coefficients: Coefficients = ducc0.sht.analysis_2d(map=field[None], spin=0, **self._options)[0]
        return coefficients

    def velocity_on_grid(self, vorticity: Coefficients, divergence: Coefficients) -> tuple[Array, Array]:
        """Zonal and meridional velocity, m/s, of the flow that has this vorticity and divergence, 1/s."""
        southward, eastward = ducc0.sht.synthesis_2d(
            alm=self._potentials(vorticity, divergence), spin=1, **self._options, **self._size
        )
        return eastward, -southward

    def curl_and_divergence(self, zonal: Array, meridional: Array) -> tuple[Coefficients, Coefficients]:
        """Coefficients of the vertical curl and of the divergence of a vector field on the grid."""
        gradient, rotation = ducc0.sht.analysis_2d(map=np.stack([-meridional, zonal]), spin=1, **self._options)
        return -self._root * rotation, -self._root * gradient

    def at_points(self, coefficients: Coefficients, longitude: Array, latitude: Array) -> Array:
        """Values of a scalar field at points, longitudes and latitudes of one shape, rad."""
        values: Array = self._synthesize(coefficients[None, :], 0, longitude, latitude)[0]
        return values

    def velocity_at_points(
        self, vorticity: Coefficients, divergence: Coefficients, longitude: Array, latitude: Array
    ) -> tuple[Array, Array]:
        """Zonal and meridional velocity, m/s, at points, longitudes and latitudes of one shape, rad."""
        southward, eastward = self._synthesize(self._potentials(vorticity, divergence), 1, longitude, latitude)
        return eastward, -southward

    def potential_speeds(self, rotation: Coefficients) -> Coefficients:
        """Coefficients whose power is that of the velocity with this vorticity or divergence, m/s."""
        return self._inverse_root * rotation

    def power(self, coefficients: Coefficients) -> Array:
        """Mean square of a field by total wavenumber (truncation + 1,); its sum is the mean square over the sphere."""
        twice = np.where(np.arange(len(coefficients)) > self.truncation, 2.0, 1.0)
        return np.bincount(self.degree, twice * np.abs(coefficients) ** 2) / (4.0 * np.pi)

    def root_mean_square(self, fields: Coefficients) -> float:
        """Root mean square over the sphere of a vector whose components have the coefficients (n, n_coefficients)."""
        return math.sqrt(sum(self.power(field).sum() for field in fields))

    def _potentials(self, vorticity: Coefficients, divergence: Coefficients) -> Coefficients:
        # ducc0's gradient and curl components are those of potentials times sqrt(l (l + 1)), on the unit sphere.
        return np.stack([-self._inverse_root * divergence, -self._inverse_root * vorticity])

    def _synthesize(self, coefficients: Coefficients, spin: int, longitude: Array, latitude: Array) -> Array:
        places = np.stack([0.5 * np.pi - latitude.ravel(), eastward(longitude.ravel())], axis=-1)
        values: Array = ducc0.sht.synthesis_general(
            alm=coefficients,
            spin=spin,
            lmax=self.truncation,
            loc=places,
            epsilon=POINT_ACCURACY,
        )
        return values.reshape(-1, *longitude.shape)


def degrees(truncation: int) -> Index:
    """Total wavenumber of every coefficient (n_coefficients,)."""
    return np.concatenate([np.arange(order, truncation + 1) for order in range(truncation + 1)])


def truncation_of(coefficients: Coefficients) -> int:
    """Highest total wavenumber of coefficients, which are along the last dimension."""
    return math.isqrt(2 * coefficients.shape[-1]) - 1


def truncated(coefficients: Coefficients, truncation: int) -> Coefficients:
    """Coefficients up to a lower total wavenumber."""
    kept: Coefficients = coefficients[..., degrees(truncation_of(coefficients)) <= truncation]
    return kept
