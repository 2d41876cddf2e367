"""Error norms of Williamson et al. (1992), section 2.4, equations (82) to (84)."""

import numpy as np

from mesh.arrays import Array


def l1_norm(values: Array, reference: Array, area: Array) -> float:
    """Area-weighted integral of |values - reference| over that of |reference|."""
    return float(np.sum(area * np.abs(values - reference)) / np.sum(area * np.abs(reference)))


def l2_norm(values: Array, reference: Array, area: Array) -> float:
    """Root of the area-weighted integral of (values - reference)^2 over that of reference^2."""
    return float(np.sqrt(np.sum(area * (values - reference) ** 2) / np.sum(area * reference**2)))


def linf_norm(values: Array, reference: Array) -> float:
    """Largest |values - reference| over the largest |reference|."""
    return float(np.abs(values - reference).max() / np.abs(reference).max())
