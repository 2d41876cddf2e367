"""What verdicts share: numbers, lists and places in words, and when two numbers count as equal."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise

import numpy as np

from postprocess.compare.shares import BANDS
from postprocess.studies.lines import to_be_named
from postprocess.studies.study_folder import StudyRow, fitted_order

EQUAL = 0.05
"""Two errors that differ by less than this share of the larger one are called equal."""

ROUND_OFF = 1e-13
"""Relative errors below this are round-off."""

OUTSTANDING = 1.5
"""A zone stands out where its share of the squared error is this many times its share of the area."""

LEAST_SHARE = 0.1
"""A band of latitude with less of the squared error than this is not worth a word."""

MOST_AREA = 0.5
"""A zone of more of the area than this cannot stand out."""

ZONE_WORDS = {
    "near_irregular": "within two cells of a cell that is no hexagon",
    "near_coast": "within two cells of the coast",
    "refined": "in the refined part",
    "transition": "at the transition of the refinement",
    "coarse": "in the coarse part",
}
"""Zones that are no bands of latitude."""

ASKED = {"band of latitude": tuple(BANDS), "zone of the refinement": ("transition",)}
"""Zones that are named where none of them stands out, by what they are called."""

Verdict = Mapping[str, Sequence[str]]
"""Sentences by the question that they answer."""


def listed(items: Iterable[str]) -> str:
    """Items as in "a, b and c"."""
    *first, last = items
    return f"{', '.join(first)} and {last}" if first else last


def counted(count: int, one: str, many: str) -> str:
    """A count with its noun."""
    return f"{count} {one if count == 1 else many}"


def number(value: float) -> str:
    """A number to three digits."""
    return f"{value:.3g}"


def times(ratio: float) -> str:
    """A ratio as in "3.1 times", with two decimals where it is less than two."""
    return f"{ratio:.{0 if ratio >= 10.0 else 1 if ratio >= 2.0 else 2}f} times"


def percent(share: float) -> str:
    """A share in percent: whole numbers from ten on, two digits below."""
    value = 100.0 * share
    return f"{value:.0f}%" if value >= 10.0 or value == 0.0 else f"{value:.2g}%"


def are_equal(a: float, b: float, uncertainty: float = 0.0) -> bool:
    """Whether two errors count as equal: within 5% of the larger, or within the uncertainty of both."""
    return abs(a - b) < EQUAL * max(a, b) or abs(a - b) <= uncertainty


def spoken(family: str, scheme: str, schemes: Iterable[str]) -> str:
    """What a line is called within a sentence, in a study of these schemes."""
    return f"{family} ({scheme})" if to_be_named(schemes) else family


def order_in_words(size: Sequence[float], error: Sequence[float], sizes: str = "sizes") -> str:
    """The fitted order of errors, none of them zero, over two or more sizes, and its spread, or that it has none.

    `sizes` says what they are, such as sizes of meshes or time steps.
    """
    fitted = fitted_order(size, error)
    if len(size) == 2:
        return f"order {fitted:.2f} (from two {sizes} alone, so its spread is not known)"
    steps = [fitted_order(two, of_two) for two, of_two in zip(pairwise(size), pairwise(error), strict=True)]
    return f"order {fitted:.2f} ({min(steps):.2f} to {max(steps):.2f} between successive {sizes})"


def compared_with_theory(order: float, expected: float, tolerance: float, what: str) -> str:
    """Whether an order is the one that theory gives, the name of which is `what`."""
    if abs(order - expected) <= tolerance:
        return f"the {what} that theory expects"
    return f"{'above' if order > expected else 'below'} the {what} that theory expects"


def has_shares(row: StudyRow) -> bool:
    """Whether a row tells where its error lives."""
    return any(name.startswith("error_share_") for name in row)


def where_in_words(name: str, row: StudyRow, error: str = "error") -> str:
    """A sentence on where the error of the line or run of this name lives, from the shares in its row."""
    bands = [zone for zone in BANDS if row.get(f"error_share_{zone}", 0.0) >= LEAST_SHARE and stands_out(row, zone)]
    found = [_share(row, bands, listed(map(zone_in_words, bands)))] if bands else []
    found += [_share(row, [zone], words) for zone, words in ZONE_WORDS.items() if stands_out(row, zone)]
    if found:
        return f"Of the squared {error} of {name}, {listed(found)}."
    asked = [words for words, zones in ASKED.items() if any(f"error_share_{zone}" in row for zone in zones)]
    spread = f"The squared {error} of {name} is spread"
    if asked:
        spread += f": no {' and no '.join(asked)} holds {OUTSTANDING:g} times its share of the area"
    return f"{spread}{_irregular(row)}."


def _irregular(row: StudyRow) -> str:
    """What is near irregular cells, which do not stand out."""
    if "error_share_near_irregular" not in row:
        return ""
    area = row["area_share_near_irregular"]
    if area > MOST_AREA:
        return f", and {percent(area)} of the area are within two cells of one that is no hexagon, too much to tell"
    share = percent(row["error_share_near_irregular"])
    return f", and {share} of it are within two cells of one that is no hexagon ({percent(area)} of the area)"


def stands_out(row: StudyRow, zone: str) -> bool:
    """Whether a zone, of at most half of the area, holds far more of the squared error than of the area."""
    error, area = row.get(f"error_share_{zone}", 0.0), row.get(f"area_share_{zone}", 1.0)
    return bool(area <= MOST_AREA and error >= OUTSTANDING * area)


def _share(row: StudyRow, zones: Sequence[str], words: str) -> str:
    error, area = (float(np.sum([row[f"{kind}_share_{zone}"] for zone in zones])) for kind in ("error", "area"))
    return f"{percent(error)} lie {words} ({percent(area)} of the area)"


def zone_in_words(zone: str) -> str:
    """Where a zone is, as in "between 30°N and 60°N"."""
    if zone in ZONE_WORDS:
        return ZONE_WORDS[zone]
    south, north = BANDS[zone]
    if south == -90.0:
        return f"south of {-north:g}°S"
    if north == 90.0:
        return f"north of {south:g}°N"
    return f"between {_parallel(south)} and {_parallel(north)}"


def _parallel(latitude: float) -> str:
    if latitude == 0.0:
        return "the equator"
    return f"{abs(latitude):g}°{'N' if latitude > 0.0 else 'S'}"
