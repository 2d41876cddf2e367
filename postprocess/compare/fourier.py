"""Fourier spectra of fields on a plane that repeats itself in both directions."""

from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array


@dataclass(frozen=True)
class Fourier:
    """Waves on a plane of these `periods`, m, sampled so that `resolved` of them fit the longer one, two places a wave.

    The wavenumber of a wave is how many of its length fit the longer period, rounded.
    """

    periods: tuple[float, float]
    resolved: int

    @property
    def _shape(self) -> tuple[int, int]:
        """Places along y and along x, an odd number of each so that every wave has its opposite."""
        longer = max(self.periods)
        columns, rows = (2 * int(self.resolved * period / longer) + 1 for period in self.periods)
        return rows, columns

    @property
    def points(self) -> tuple[Array, Array]:
        """Places x and y (n,), m, at which fields are sampled."""
        rows, columns = self._shape
        x = self.periods[0] * np.arange(columns, dtype=np.float64) / columns
        y = self.periods[1] * np.arange(rows, dtype=np.float64) / rows
        return np.tile(x, rows), np.repeat(y, columns)

    def power(self, field: Array) -> Array:
        """Mean square of a field (n,) at `points` by wavenumber 0, 1, ..., as far as there are waves."""
        rows, columns = self._shape
        squares = np.abs(np.fft.fft2(field.reshape(rows, columns)) / field.size) ** 2
        longer = max(self.periods)
        along = np.fft.fftfreq(columns, 1.0 / columns) * longer / self.periods[0]
        up = np.fft.fftfreq(rows, 1.0 / rows) * longer / self.periods[1]
        wavenumber = np.rint(np.hypot(along[None, :], up[:, None])).astype(np.int64)
        return np.asarray(np.bincount(wavenumber.ravel(), squares.ravel()), dtype=np.float64)
