import numpy as np
import pytest

from mesh import scvt_mesh
from postprocess.compare.shares import BANDS, error_shares, shares_as_columns, zones
from postprocess.studies.families import FAMILIES


def test_shares_of_an_even_error_are_those_of_the_area() -> None:
    mesh = scvt_mesh(642)
    shares = error_shares(mesh, np.full(mesh.n_cells, -3.0))
    assert sum(shares[band].area for band in BANDS) == pytest.approx(1.0)
    assert set(shares) == {*BANDS, "near_irregular"}
    for share in shares.values():
        assert share.error == pytest.approx(share.area)
    assert shares["near_irregular"].area == pytest.approx(12 * (1 + 5 + 10) / 642, abs=0.02)


def test_an_error_at_one_cell_lies_in_its_zones() -> None:
    mesh = scvt_mesh(642)
    error = np.zeros(mesh.n_cells)
    error[np.argmax(mesh.lat_cell)] = 1.0
    shares = error_shares(mesh, error)
    assert shares["north_of_60n"].error == 1.0
    assert shares["south_of_60s"].error == 0.0
    assert shares_as_columns(shares)["error_share_north_of_60n"] == 1.0
    assert error_shares(mesh, 0.0 * error) == {}


def test_a_refined_mesh_has_a_fine_part_a_transition_and_a_coarse_part() -> None:
    mesh = FAMILIES["refined-circle"].make(642)
    found = zones(mesh)
    parts = [found[name] for name in ("refined", "transition", "coarse")]
    np.testing.assert_array_equal(np.sum(parts, axis=0), 1)
    means = [mesh.area_cell[part].mean() for part in parts]
    assert means == sorted(means)
    assert "refined" not in zones(scvt_mesh(642))
