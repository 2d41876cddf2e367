"""Which of several runs has the smallest errors, and by what factor: from rows to sentences."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from postprocess.reports.sentences import ROUND_OFF, are_equal, listed, number, times
from postprocess.studies.study_folder import StudyRow

FIELD_WORDS = {
    "thickness": "thickness",
    "velocity": "velocity",
    "normal_velocity": "normal velocity",
    "vorticity": "vorticity",
}
"""Fields that have norms, in words; their columns are such as `thickness_l2`."""

OTHER_COLUMNS = ("thickness_linf", "normal_velocity_l2", "vorticity_l2")
"""Norms that may agree with the l2 norm of thickness or not."""


@dataclass(frozen=True)
class Wording:
    """What rows hold, alone and in the singular and plural with the word that joins it to a field."""

    noun: str
    one: str
    many: str


ERROR = Wording("error", "error of", "errors of")
"""From a solution."""

DIFFERENCE = Wording("difference", "difference in", "differences in")
"""From another run, which has errors of its own."""

Rows = Mapping[str, StudyRow]
"""Rows by the names of what they are of, all on one size of mesh or one day."""


def ranking(
    rows: Rows, start: str, word: Wording = ERROR, field: str = "thickness", others: Sequence[str] = OTHER_COLUMNS
) -> list[str]:
    """Which of the rows has the smallest l2 norm of `field`, by what factor, and whether the columns `others` agree.

    The first sentence begins with `start`, which says where or when. No norm of `field` may be zero.
    """
    found = [_smallest(rows, start, word, field)]
    best = best_of(rows, f"{field}_l2")
    agreeing = [column for column in others if set(best) == set(_known_best(rows, column))]
    if agreeing:
        found.append(f"The same holds of {listed(_in_words(column, word) for column in agreeing)}.")
    found += [_another(rows, column, word, best) for column in others if column not in agreeing]
    return [sentence for sentence in found if sentence]


def best_of(rows: Rows, column: str = "thickness_l2") -> list[str]:
    """Names of those whose norm is the smallest or equal to it, the smallest first."""
    ranked = sorted(rows, key=lambda name: float(rows[name][column]))
    least = rows[ranked[0]]
    uncertainty = uncertainty_of(least, column)
    return [name for name in ranked if are_equal(rows[name][column], least[column], uncertainty)]


def uncertainty_of(row: StudyRow, column: str) -> float:
    """Uncertainty of the reference that goes with an l2 error; zero where none is known."""
    name = {
        "thickness_l2": "thickness",
        "velocity_l2": "velocity",
        "normal_velocity_l2": "velocity",
        "vorticity_l2": "vorticity",
    }.get(column)
    return float(row.get(f"uncertainty_{name}", 0.0))


def _in_words(column: str, word: Wording) -> str:
    """A column, as in "the largest error of thickness"."""
    field, norm = column.rsplit("_", 1)
    return f"the {'largest ' if norm == 'linf' else ''}{word.one} {FIELD_WORDS[field]}"


def _smallest(rows: Rows, start: str, word: Wording, field: str) -> str:
    column, what = f"{field}_l2", FIELD_WORDS[field]
    best = best_of(rows, column)
    least = float(rows[best[0]][column])
    others = sorted((name for name in rows if name not in best), key=lambda name: float(rows[name][column]))
    if len(best) == 1:
        told = f"{start} {best[0]} has the smallest l2 {word.one} {what}, {number(least)}"
    else:
        uncertainty = uncertainty_of(rows[best[0]], column)
        within = f", or by less than the uncertainty of the reference, {number(uncertainty)}" if uncertainty else ""
        whose = "the smallest ones, about" if others else "both about" if len(best) == 2 else "all about"
        told = (
            f"{start} the l2 {word.many} {what} of {listed(best)}, {whose} {number(least)}, are equal: they differ by "
            f"less than 5%{within}"
        )
    ends = [f"that of {name} is {times(rows[name][column] / least)} as large" for name in others]
    return f"{told}; {listed(ends)}." if ends else f"{told}."


def _known_best(rows: Rows, column: str) -> list[str]:
    """The best by another norm; empty where it is not known or at round-off."""
    return best_of(rows, column) if all(row.get(column, 0.0) > ROUND_OFF for row in rows.values()) else []


def _another(rows: Rows, column: str, word: Wording, best: Sequence[str]) -> str:
    """Which rows are best by another norm, others than by the first; empty where it is not known."""
    here = _known_best(rows, column)
    if not here:
        return ""
    what = _in_words(column, word)
    if len(here) > 1:
        return f"By {what}, {listed(here)} are equal{'' if len(here) == len(rows) else ' and the smallest'}."
    if here[0] in best:
        second = min(float(row[column]) for name, row in rows.items() if name != here[0])
        return f"By {what}, {here[0]} is best; the next is {times(second / rows[here[0]][column])} as large."
    ratio = rows[best[0]][column] / rows[here[0]][column]
    return f"By {what}, {here[0]} is best; that of {best[0]} is {times(ratio)} as large."
