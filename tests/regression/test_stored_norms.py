"""Results are those of the last version that was looked at; `make_norms.py` makes the stored ones anew."""

import json

import pytest
from make_norms import NORMS_FILE, compute_norms


def test_norms_are_as_stored() -> None:
    stored, found = json.loads(NORMS_FILE.read_text()), compute_norms()
    assert set(found) == set(stored)
    for name, value in stored.items():
        assert found[name] == pytest.approx(value, rel=1e-6), name
