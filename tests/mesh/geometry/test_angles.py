"""Angles in one turn, and the one place where they are brought there."""

import ast
from pathlib import Path

import numpy as np
import pytest

from mesh.geometry.angles import (
    TURN,
    about_zero,
    degrees_eastward,
    eastward,
    eastward_of_half_turns,
    whole_degrees_east,
)

ROOT = Path(__file__).parents[3]
ANGLES = np.array([-7.0, -np.pi, -1e-20, -0.0, 0.0, 1.0, np.pi, 4.0, TURN, 9.0, 100.0])


def test_angles_about_zero() -> None:
    wrapped = about_zero(ANGLES)
    assert np.all((wrapped >= -np.pi) & (wrapped < np.pi))
    np.testing.assert_allclose(np.exp(1j * wrapped), np.exp(1j * ANGLES), atol=1e-13)
    np.testing.assert_allclose(about_zero(np.array([np.pi, 4.0])), [-np.pi, 4.0 - TURN], atol=1e-15)


def test_degrees_end_below_a_turn() -> None:
    angles = np.array([-400.0, -1e-20, 0.0, 359.5, 360.0, 725.0])
    np.testing.assert_array_equal(degrees_eastward(angles), [320.0, 0.0, 0.0, 359.5, 0.0, 5.0])


def test_eastward_angles_end_below_a_turn() -> None:
    wrapped = eastward(ANGLES)
    assert np.all((wrapped >= 0.0) & (wrapped < TURN))
    np.testing.assert_allclose(np.exp(1j * wrapped), np.exp(1j * ANGLES), atol=1e-13)
    assert eastward(np.array([-1e-20, TURN])).tolist() == [0.0, 0.0]


def test_half_turns_need_no_division() -> None:
    angles = np.concatenate([np.linspace(-np.pi, np.pi, 1001), [-1e-20, -1e-9]])
    np.testing.assert_array_equal(eastward_of_half_turns(angles), eastward(angles))
    assert np.signbit(eastward_of_half_turns(np.array(-0.0)))


@pytest.mark.parametrize(("longitude", "degrees"), [(0.0, 0), (-np.pi / 3, 300), (-1e-9, 0), (7.0 * np.pi, 180)])
def test_labels_of_maps(longitude: float, degrees: int) -> None:
    assert whole_degrees_east(longitude) == degrees


def turns_in(source: str) -> list[str]:
    """What a source reduces by a full turn."""
    remainders = (
        ast.unparse(node)
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod)
    )
    return [text for text in remainders if any(turn in text.rpartition("%")[2] for turn in ("pi", "TURN", "360"))]


def test_angles_are_wrapped_in_one_place() -> None:
    packages = ("mesh", "swe", "cases", "postprocess", "trisk")
    files = [path for package in packages for path in (ROOT / package).rglob("*.py")]
    users = [path.relative_to(ROOT).as_posix() for path in files if turns_in(path.read_text())]
    assert users == ["mesh/geometry/angles.py"]
    assert turns_in("(a + np.pi) % (2.0 * np.pi) - np.pi")
