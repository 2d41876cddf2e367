"""Palettes are those of cmocean, and each field has the colours that suit its values."""

import subprocess
import sys

import numpy as np
import pytest

from postprocess.figures import palettes
from postprocess.figures.palettes import FIELD_COLOURS, FieldColours, colours_for, deviation_colours, palette
from swe.errors import InputError


@pytest.mark.parametrize(
    "name",
    sorted({name for each in (FieldColours(), *FIELD_COLOURS.values()) for name in (each.one_sign, each.both_signs)}),
)
def test_palettes_are_those_of_cmocean(name: str) -> None:
    cmocean = pytest.importorskip("cmocean")
    places = np.linspace(0.0, 1.0, 33)
    np.testing.assert_allclose(palette(name)(places), getattr(cmocean.cm, name)(places), atol=0.02)
    assert palette(name).name == f"cmo.{name}"


def test_pyplot_and_the_registry_stay_untouched() -> None:
    program = (
        "import sys, matplotlib; before = set(matplotlib.colormaps)\n"
        "from postprocess.figures.palettes import palette; palette('balance')\n"
        "print('cmocean' in sys.modules, 'matplotlib.pyplot' in sys.modules, set(matplotlib.colormaps) == before)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False", "True"]


@pytest.mark.parametrize(
    ("name", "values", "expected"),
    [
        ("thickness", [2.0, 5.0], ("deep", 2.0, 5.0, False)),
        ("thickness", [-2.0, 1.0], ("balance", -2.0, 2.0, True)),
        ("kinetic_energy", [2.0, np.nan, 5.0], ("speed", 0.0, 5.0, False)),
        ("velocity_zonal", [-1.0, 3.0], ("balance", -3.0, 3.0, True)),
        ("potential_vorticity", [-1.0, 3.0], ("curl", -3.0, 3.0, True)),
        ("potential_vorticity", [1.0, 3.0], ("tempo", 1.0, 3.0, False)),
        ("of the user's own", [1.0, 3.0], ("haline", 1.0, 3.0, False)),
        ("", [np.nan], ("haline", 0.0, 1.0, False)),
    ],
)
def test_colours_follow_the_field_and_its_signs(
    name: str, values: list[float], expected: tuple[str, float, float, bool]
) -> None:
    found = colours_for(name, np.array(values))
    assert (found.palette, found.lowest, found.highest, found.centred) == expected
    options = found.options
    assert options["cmap"].name == f"cmo.{expected[0]}"
    assert (options["norm"].vmin, options["norm"].vmax) == expected[1:3]


def test_several_maps_share_their_colours() -> None:
    found = colours_for("thickness", [np.array([1.0, 2.0]), np.array([4.0])])
    assert (found.lowest, found.highest) == (1.0, 4.0)


@pytest.mark.parametrize(("values", "reach"), [([1.0, 3.0], 3.0), ([-5.0, -1.0], 5.0), ([0.0], 1.0)])
def test_deviations_have_zero_in_the_middle(values: list[float], reach: float) -> None:
    found = deviation_colours(np.array(values))
    assert (found.palette, found.lowest, found.highest, found.centred) == ("balance", -reach, reach, True)
    assert deviation_colours(np.array(values), 7.0).highest == 7.0


def test_a_palette_that_is_none_and_cmocean_that_is_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match=r"cmocean has no palette named 'rainbow'; choose one of algae, amp, .*turbid"):
        palettes.palette_colours("rainbow")
    monkeypatch.setattr(palettes, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"cmocean, which is missing; install it with pip install cmocean"):
        palettes.palette_colours("balance")
