"""Meshes that several tests of this folder share."""

import pytest

from mesh import VoronoiMesh, scvt_mesh


@pytest.fixture(scope="session")
def refined_mesh() -> VoronoiMesh:
    """Cells three times narrower within 30 degrees of 270 E, 30 N than elsewhere."""
    return scvt_mesh(1000, density="refined-circle", tolerance=1e-3)
