"""The verdict on compared runs: pure functions from rows, one a run and day, to sentences."""

from collections.abc import Sequence

from postprocess.reports.ranking import FIELD_WORDS, Wording, ranking
from postprocess.reports.sentences import ROUND_OFF, Verdict, has_shares, listed, number, percent, where_in_words
from postprocess.studies.study_folder import StudyRow

LEVELS = (0.001, 0.01, 0.1)
"""Relative norms of which it is told when they are first exceeded."""

LEAST_PERCENTAGE = 1e-6
"""Relative norms below this are told as numbers, not in percent."""

NORMS = "l2 is the root mean square over the area and l∞ the largest value, each divided by that of the reference."


def comparison_verdict(rows: Sequence[StudyRow], reference: str, word: Wording) -> Verdict:
    """What a comparison with `reference` found, by question.

    Rows have `run`, `cells`, `day` and such norms as exist; those of the last day have shares by zone, where there is
    an error.
    """
    day = max(float(row["day"]) for row in rows)
    last = {str(row["run"]): row for row in rows if row["day"] == day}
    field = next((name for name in FIELD_WORDS if all(f"{name}_l2" in row for row in last.values())), None)
    if field is None:
        return {f"How large the {word.noun} is": ["The reference is zero everywhere, so no relative norm exists."]}
    whom = "Which run is nearer to" if len(last) == 2 else "Which run is nearest to"
    return {
        f"{whom} {reference}": nearest(last, day, field, word) if len(last) > 1 else [],
        f"How large the {word.noun} is": sizes(last, day),
        f"When the {word.noun} grows": growth(rows, field, word),
        f"Where the {word.noun} lies": [
            where_in_words(name, row, f"{word.one} thickness") for name, row in last.items() if has_shares(row)
        ],
    }


def nearest(last: dict[str, StudyRow], day: float, field: str, word: Wording) -> list[str]:
    """Which of several runs is nearest on the last day by the l2 norm of `field`, and whether other norms agree."""
    column = f"{field}_l2"
    same = [name for name, row in last.items() if row[column] < ROUND_OFF]
    if not same:
        others = [f"{field}_linf", *(f"{name}_l2" for name in FIELD_WORDS if name != field)]
        return ranking(last, f"On day {day:g}", word, field, others)
    told = f"On day {day:g} the l2 {word.one} {FIELD_WORDS[field]} is at round-off for {listed(same)}"
    rest = [f"{number(row[column])} for {name}" for name, row in last.items() if name not in same]
    return [f"{told}; it is {listed(rest)}." if rest else f"{told}."]


def sizes(last: dict[str, StudyRow], day: float) -> list[str]:
    """The norms of each run on the last day in words, and what they mean."""
    found = []
    for name, row in last.items():
        fields = {field: words for field, words in FIELD_WORDS.items() if f"{field}_l2" in row}
        norms = [
            f"{words} by {relative(row[f'{field}_l2'])} (l2) and at most {relative(row[f'{field}_linf'])} (l∞)"
            for field, words in fields.items()
        ]
        found.append(f"{name}, of {row['cells']} cells, is off on day {day:g} in {listed(norms)}.")
    uncertain = [
        f"{relative(row[f'uncertainty_{field}'])} in {words}"
        for row in list(last.values())[:1]
        for field, words in FIELD_WORDS.items()
        if f"uncertainty_{field}" in row
    ]
    if uncertain:
        found.append(f"The reference itself is uncertain by {listed(uncertain)} (l2).")
    return [*found, NORMS]


def relative(value: float) -> str:
    """A relative norm in percent, or as a number where it is tiny."""
    return percent(value) if value >= LEAST_PERCENTAGE or value == 0.0 else number(value)


def growth(rows: Sequence[StudyRow], field: str, word: Wording) -> list[str]:
    """On which of the days, if there are several, the l2 norm of `field` of each run is first above each level."""
    days = sorted({float(row["day"]) for row in rows})
    if len(days) < 2:
        return []
    lines: dict[str, list[StudyRow]] = {}
    for row in sorted(rows, key=lambda row: float(row["day"])):
        lines.setdefault(str(row["run"]), []).append(row)
    start = f"The l2 {word.one} {FIELD_WORDS[field]} of"
    return [f"{start} {name} is {_first_above(line, f'{field}_l2')}." for name, line in lines.items()]


def _first_above(line: Sequence[StudyRow], column: str) -> str:
    """When the norms of a run, in the order of days, are first above each level."""
    above: dict[float, list[str]] = {}
    never = []
    for level in LEVELS:
        days = [float(row["day"]) for row in line if row.get(column, 0.0) > level]
        if days:
            above.setdefault(days[0], []).append(percent(level))
        else:
            never.append(percent(level))
    if not above:
        return f"never above {never[0]} on the {len(line)} days compared"
    told = listed(f"above {listed(levels)} on day {day:g}" for day, levels in above.items())
    rest = f", and never above {never[0]}" if never else ""
    return f"first {told}{rest}, of the {len(line)} days compared"
