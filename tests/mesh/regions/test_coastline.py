"""Coastlines: what is finer than the spacing goes, what is wider stays."""

from collections.abc import Callable

import numpy as np
import pytest

from mesh.arrays import Array
from mesh.geometry.sphere import arc_length, from_lonlat
from mesh.regions.coastline import _evenly_spaced
from mesh.regions.outline import joined, signed, straight_on_the_map
from mesh.regions.region import Region
from tests.mesh.regions.rings import area_within, crossings, steps

SPACING = np.radians(1.0)


def boxes(
    *sea: tuple[float, float, float, float], islands: tuple[tuple[float, float, float, float], ...] = ()
) -> Region:
    """A sea of overlapping boxes (west, east, south, north) in degrees near the equator, with islands in it."""

    def inside_of(box: tuple[float, float, float, float], points: Array) -> Array:
        west, east, south, north = np.radians(box)
        longitude, latitude = np.arctan2(points[:, 1], points[:, 0]), np.arcsin(points[:, 2])
        return np.minimum(
            np.minimum(longitude - west, east - longitude), np.minimum(latitude - south, north - latitude)
        )

    def distance(points: Array) -> Array:
        water = np.max([inside_of(box, points) for box in sea], axis=0)
        return np.min([water, *(-inside_of(box, points) for box in islands)], axis=0)

    return Region("boxes", distance)


def square(area: float) -> float:
    """Square degrees near the equator in steradians."""
    return float(np.radians(1.0) ** 2 * area)


@pytest.mark.parametrize(("width", "open_to_all"), [(0.7, False), (1.5, True)])
def test_a_channel_narrower_than_the_spacing_closes(width: float, open_to_all: bool) -> None:
    region = boxes((-12, -2, -5, 5), (2, 10, -5, 5), (-3, 3, -0.5 * width, 0.5 * width))
    (ring,) = region.coastline(SPACING)
    assert np.isclose(area_within([ring]), square(100 + (80 + 4 * width if open_to_all else 0)), rtol=0.02)
    assert len(region.coastline(SPACING, all_seas=True)) == (1 if open_to_all else 2)


@pytest.mark.parametrize(("width", "stays"), [(0.7, False), (1.6, True)])
def test_an_island_narrower_than_the_spacing_goes(width: float, stays: bool) -> None:
    region = boxes((-8, 8, -5, 5), islands=((-2, 2, 0, width),))
    rings = region.coastline(SPACING)
    assert len(rings) == (2 if stays else 1)
    assert np.isclose(area_within(rings), square(160 - (4 * width - 0.5 if stays else 0)), rtol=0.01)
    assert crossings(rings) == 0


@pytest.mark.parametrize("depth", [1.0, -1.0], ids=["inlets", "spits"])
def test_teeth_narrower_than_the_spacing_go(depth: float) -> None:
    """Four of them, of 0.5 degrees' width, beside a wall which then is straight."""
    teeth = [(x, x + 0.5, 4.0, 7.0) for x in (-5.0, -2.0, 1.0, 4.0)]
    inlets, spits = boxes((-8, 8, -5, 5), *teeth), boxes((-8, 8, -5, 7), islands=tuple(teeth))
    region = inlets if depth > 0.0 else spits
    rings = region.coastline(SPACING)
    wall = 5.0 if depth > 0.0 else 7.0
    northern = np.degrees(rings[0][:, 2])[np.abs(rings[0][:, 1]) < np.radians(5.0)]
    northern = northern[northern > 0.0]
    assert len(rings) == 1
    assert np.ptp(northern) < 0.4
    assert abs(northern.mean() - wall) < 0.3


def test_bends_are_no_sharper_than_half_a_spacing(wavy: Region) -> None:
    """A star of 40 rays, each 0.8 spacings wide where it begins."""
    rings = wavy.coastline(SPACING)
    ring = rings[0]
    before, after = ring - np.roll(ring, 1, axis=0), np.roll(ring, -1, axis=0) - ring
    turn = np.arccos(
        np.einsum("ij,ij->i", before, after) / np.linalg.norm(before, axis=1) / np.linalg.norm(after, axis=1)
    )
    assert turn.max() < 0.25 / 0.4
    assert crossings(rings) == 0
    assert 0.2 < steps(rings).min() / SPACING <= steps(rings).max() / SPACING < 0.26


@pytest.fixture
def wavy() -> Region:
    angle = np.linspace(0.0, 2 * np.pi, 401)
    radius = np.radians(6.0) * (1.0 + 0.3 * np.sign(np.sin(40 * angle)) * np.abs(np.sin(40 * angle)) ** 0.3)
    line = joined([straight_on_the_map(radius * np.cos(angle), radius * np.sin(angle))])

    def distance(points: Array) -> Array:
        longitude, latitude = np.arctan2(points[:, 1], points[:, 0]), np.arcsin(points[:, 2])
        edge = np.interp(np.arctan2(latitude, longitude) % (2 * np.pi), angle, radius)
        return signed(line.distance(points), np.hypot(longitude, latitude) < edge)

    return Region("star", distance)


def test_the_largest_sea_is_chosen_by_area() -> None:
    """The smaller of two has the longer coast."""
    islands = tuple((x, x + 1.5, -1.0, 0.5) for x in (12.0, 15.0))
    region = boxes((-8, 8, -5, 5), (10, 19, -3, 3), islands=islands)
    (ring,) = region.coastline(SPACING)
    assert np.isclose(area_within([ring]), square(160), rtol=0.01)
    rings = region.coastline(SPACING, all_seas=True)
    assert [len(ring) for ring in rings] == sorted((len(ring) for ring in rings), reverse=True)
    assert len(rings) == 4


def test_a_round_island_keeps_its_size() -> None:
    center = from_lonlat(np.array(2.0), np.array(-1.0))
    away: Callable[[Array], Array] = lambda points: arc_length(points, center) - 2 * SPACING  # noqa: E731
    (ring,) = Region("sea", away).coastline(SPACING)
    np.testing.assert_allclose(arc_length(ring, center), 2 * SPACING, rtol=0.02)
    assert area_within([ring]) < 0.0


def test_small_islands_go_rather_than_make_a_wall() -> None:
    """Rows of islands from coast to coast, which with their gaps, as narrow, would be a broad one."""
    rows = tuple((x, x + 0.6, y, y + 0.6) for x in (-2.0, -0.8, 0.4, 1.6) for y in np.arange(-4.8, 4.5, 1.2))
    rings = boxes((-8, 8, -5, 5), islands=rows).coastline(SPACING)
    assert len(rings) == 1
    assert np.isclose(area_within(rings), square(160), rtol=0.02)


def test_rings_are_smoothed_along_themselves() -> None:
    """A circle with teeth of a quarter of a spacing's length, and of a tenth's height either way."""
    angle = np.linspace(0.0, 2 * np.pi, 1600, endpoint=False)
    radius = 5 * SPACING + 0.1 * SPACING * np.sin(angle * round(2 * np.pi * 5 / 0.25))
    ring = _evenly_spaced(from_lonlat(radius * np.cos(angle), radius * np.sin(angle)), SPACING)
    away = arc_length(ring, np.array([1.0, 0.0, 0.0])) / SPACING
    assert np.ptp(away) < 0.02
    assert abs(away.mean() - 5.0) < 0.02
