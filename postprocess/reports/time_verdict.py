"""The verdict on a study of time steps: pure functions from the rows of its table to sentences."""

from collections.abc import Sequence

from postprocess.reports.sentences import (
    ROUND_OFF,
    Verdict,
    are_equal,
    compared_with_theory,
    counted,
    listed,
    number,
    order_in_words,
    times,
)
from postprocess.studies.lines import to_be_named
from postprocess.studies.study_folder import StudyRow, fitted_order
from postprocess.studies.time_study import ORDER_OF_ENERGY_DRIFT, by_scheme

ORDER_TOLERANCE = 0.4
"""Orders this near to the expected one are called as expected: they bend towards the limit of stability."""

ENERGY = "total_energy_change_of_total"
MEASURES = {
    ENERGY: ("the drift of total energy", ORDER_OF_ENERGY_DRIFT, "fifth order"),
    "thickness_difference_l2": ("the difference in thickness from", ORDER_OF_ENERGY_DRIFT - 1, "fourth order"),
    "velocity_difference_l2": ("the difference in velocity from", ORDER_OF_ENERGY_DRIFT - 1, "fourth order"),
}
"""What orders are told of: in words, the order that theory expects, and what it is called.

Differences are those from the run with the shortest step.
"""


ALL_RUNS = {1: "the one run", 2: "both runs"}
"""All runs of a scheme in words, where there are few."""


def time_verdict(rows: Sequence[StudyRow]) -> Verdict:
    """What a study of time steps found, by question."""
    lines = by_scheme(rows)
    named = to_be_named(lines)
    steps, orders, gains = [], [], []
    for scheme, line in lines.items():
        prefix = f"With {scheme}, " if named else ""
        line = sorted(line, key=lambda row: float(row["time_step_s"]))
        finished = [row for row in line if "steps" in row]
        steps.append(_started(prefix, _longest(line, finished)))
        orders += [_started(prefix, _order(finished, name)) for name in MEASURES]
        if any("thickness_difference_l2" in row for row in finished):
            orders.append(_started(prefix, _own_error(finished)))
        gains.append(_started(prefix, _gain(finished)))
    verdict = {"Which time steps ran": steps, "Which order": orders, "What a longer step gains": gains}
    return verdict | ({"Which scheme drifts less": [_schemes(lines)]} if len(lines) > 1 else {})


def _started(prefix: str, sentence: str) -> str:
    """A sentence, given in lower case, after what it is about, or with its capital letter."""
    return prefix + sentence if prefix else sentence[0].upper() + sentence[1:]


def _longest(line: Sequence[StudyRow], finished: Sequence[StudyRow]) -> str:
    if not finished:
        return f"{ALL_RUNS.get(len(line), f'all {len(line)} runs')} failed."
    last = finished[-1]
    told = (
        f"the longest step that ran to the end is {last['time_step_s']:g} s, of a largest Courant number of "
        f"{last['courant_number']:.2f}"
    )
    failed = [f"{row['time_step_s']:g} s" for row in line if row.get("failure")]
    if not failed:
        return f"{told}; none of {counted(len(line), 'run', 'runs')} failed."
    return f"{told}; {counted(len(failed), 'run', 'runs')} of {len(line)} failed, with {listed(failed)}."


def _order(finished: Sequence[StudyRow], name: str) -> str:
    what, expected, called = MEASURES[name]
    if name != ENERGY:
        what += f" the run with {finished[0]['time_step_s']:g} s" if finished else " the run with the shortest step"
    present = [(float(row["time_step_s"]), abs(float(row[name]))) for row in finished if name in row]
    usable = [(step, value) for step, value in present if value > ROUND_OFF]
    if present and not usable:
        return f"{what} is at round-off at every step, so it shows no order."
    if len(usable) < 2:
        return f"of {what} there are too few values above round-off ({len(usable)}) to tell an order."
    steps, values = zip(*usable, strict=True)
    left_out = len(present) - len(usable)
    aside = f" ({counted(left_out, 'value', 'values')} at round-off left out)" if left_out else ""
    judged = compared_with_theory(fitted_order(steps, values), expected, ORDER_TOLERANCE, called)
    return f"{what} has {order_in_words(steps, values, 'steps')}, {judged}{aside}."


def _own_error(finished: Sequence[StudyRow]) -> str:
    """By how much the orders of differences are too high, as the run with the shortest step has an error too.

    An error h^p gives differences h^p - s^p from the shortest step s: of the two shortest after s this tells the most.
    """
    shortest, *others = (float(row["time_step_s"]) for row in finished)
    told = f"the run with {shortest:g} s has an error of its own, so orders of differences from it come out too high"
    if len(others) < 2:
        return f"{told}."
    order = ORDER_OF_ENERGY_DRIFT - 1
    differences = [step**order - shortest**order for step in others]
    return f"{told}, by {fitted_order(others, differences) - order:.2f} where they are {order}."


def _gain(finished: Sequence[StudyRow]) -> str:
    """What the longest step saves, and how far it is from the shortest."""
    if len(finished) < 2:
        return "too few runs came to their end to compare steps."
    first, last = finished[0], finished[-1]
    differs = number(last["thickness_difference_l2"])
    return (
        f"the step of {last['time_step_s']:g} s needs {times(last['steps'] / first['steps'])} the steps of "
        f"{first['time_step_s']:g} s, and its thickness differs by {differs} (l2)."
    )


def _schemes(lines: dict[str, list[StudyRow]]) -> str:
    """Which scheme drifts least in energy at the longest step at which all of them ran."""
    drifts = {
        scheme: {float(row["time_step_s"]): abs(float(row[ENERGY])) for row in line if ENERGY in row}
        for scheme, line in lines.items()
    }
    common = set.intersection(*(set(of_step) for of_step in drifts.values()))
    if not common:
        return "No step ran to its end with every scheme, so they cannot be compared."
    step = max(common)
    ranked = sorted(drifts, key=lambda scheme: drifts[scheme][step])
    least, most = (drifts[scheme][step] for scheme in (ranked[0], ranked[-1]))
    if most < ROUND_OFF:
        return f"At {step:g} s the drift of total energy is at round-off with every scheme."
    if are_equal(least, most):
        return f"At {step:g} s total energy drifts equally with {listed(ranked)}, by {number(least)}, within 5%."
    ends = [
        f"with {scheme} {times(drifts[scheme][step] / least)} as much" if least > ROUND_OFF else f"with {scheme} more"
        for scheme in ranked[1:]
    ]
    return f"At {step:g} s total energy drifts least with {ranked[0]}, by {number(least)}; {listed(ends)}."
