"""Runs in tables and figures, by their names; and none at all."""

from pathlib import Path

import pytest

from postprocess.compare.comparison import compare_runs
from postprocess.compare.solutions import _short
from swe.errors import InputError


def test_long_names_of_runs_keep_their_last_two_parts() -> None:
    assert _short(Path("runs/tc5")) == "runs/tc5"
    assert _short(Path("/a/long/way/to/the/folder/of/many/studies/runs/tc5")) == ".../runs/tc5"


def test_nothing_to_compare() -> None:
    with pytest.raises(InputError, match="there is nothing to compare; name a run"):
        compare_runs()
