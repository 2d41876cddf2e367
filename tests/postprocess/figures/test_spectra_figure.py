"""What the chart of spectra shows."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from postprocess.figures.spectra_figure import spectra_figure


def spectra(name: str, count: int, factor: float) -> Any:
    falling = factor * np.arange(1.0, count + 1.0) ** -3.0
    run = SimpleNamespace(case="williamson5")
    words = {"name": name, "wavenumber_in_words": "total wavenumber"}
    return SimpleNamespace(run=run, **words, kinetic_energy=falling, potential_enstrophy=1e-9 * falling)


def test_lines_are_the_spectra_from_wavenumber_one_on_and_the_slopes_of_turbulence() -> None:
    given = [spectra("coarse", 30, 2.0), spectra("fine", 60, 1.0)]
    figure = spectra_figure(given)
    assert figure.get_suptitle() == "Spectra of williamson5"
    parts = (
        ("kinetic_energy", "kinetic energy per mass (m² s⁻²)", {"slope -3": -3.0, "slope -1.67": -5.0 / 3.0}),
        ("potential_enstrophy", "potential enstrophy (m⁻¹ s⁻²)", {"slope -1": -1.0}),
    )
    for axes, (name, label, slopes) in zip(figure.axes, parts, strict=True):
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("total wavenumber", label)
        assert axes.get_xscale() == axes.get_yscale() == "log"
        lines = {line.get_label(): np.array(line.get_data()) for line in axes.get_lines()}
        assert set(lines) == {"coarse", "fine", *slopes}
        for each in given:
            np.testing.assert_array_equal(lines[each.name][0], range(1, len(each.kinetic_energy)))
            np.testing.assert_array_equal(lines[each.name][1], getattr(each, name)[1:])
        for guide, slope in slopes.items():
            x, y = lines[guide]
            assert x.tolist() == [10.0, 59.0]
            # Twice the first spectrum, so that the guide stands above it.
            assert y[0] == pytest.approx(2.0 * getattr(given[0], name)[10])
            assert np.log(y[1] / y[0]) / np.log(x[1] / x[0]) == pytest.approx(slope)


def test_slopes_begin_where_the_first_spectrum_still_is() -> None:
    """That of a run on 42 cells ends at wavenumber 5."""
    figure = spectra_figure([spectra("coarse", 6, 2.0), spectra("fine", 60, 1.0)])
    (guide,) = (line for line in figure.axes[1].get_lines() if line.get_label() == "slope -1")
    np.testing.assert_allclose(guide.get_data(), [[5.0, 59.0], [2e-9 * 2.0 / 6.0**3, 2e-9 * 2.0 / 6.0**3 * 5.0 / 59.0]])
