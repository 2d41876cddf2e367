"""The verdict on a study of meshes: pure functions from the rows of its table to sentences."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from postprocess.reports.ranking import ranking, uncertainty_of
from postprocess.reports.sentences import (
    ROUND_OFF,
    Verdict,
    are_equal,
    compared_with_theory,
    counted,
    has_shares,
    listed,
    number,
    order_in_words,
    spoken,
    times,
    where_in_words,
)
from postprocess.studies.lines import lines_of, schemes_of
from postprocess.studies.study_folder import CONSERVATION, StudyRow, fitted_order

EXPECTED_ORDER = 2.0
"""Order in space that theory expects of either scheme for a smooth flow, in the l2 norm."""

ORDER_TOLERANCE = 0.25
"""Orders this near to the expected one are called as expected."""

STALLING = 1.0
"""The largest error stalls where its order is less than that of the l2 norm by this much."""

Lines = dict[str, list[StudyRow]]
"""Rows with errors by what their family and scheme are called, coarse meshes first."""


def mesh_verdict(rows: Sequence[StudyRow], accepted_order: float | None = None) -> Verdict:
    """What a study of meshes found, by question; `accepted_order` is the least of its case, if it has any."""
    failed = _failures(rows)
    conserved = {"What is conserved": _conserved(rows)}
    lines = compared_lines(rows)
    if not lines:
        return {"Which mesh is best": [*failed, "No run has an error, so meshes cannot be compared."]} | conserved
    if max(row["thickness_l2"] for line in lines.values() for row in line) < ROUND_OFF:
        told = "All errors are at round-off, so there is no best mesh and no order."
        return {"Which mesh is best": [*failed, told]} | conserved
    last = finest_rows(lines)
    return {
        "Which mesh is best": [*failed, *best_mesh(last)],
        "Which order": [*orders_in_words(lines, accepted_order), *stalling(lines)],
        "Where the error lives": [where_in_words(name, row) for name, row in last.items() if has_shares(row)],
        "What it costs": [*costs(lines), *([SAME_WORK] if len(schemes_of(rows)) > 1 else [])],
    } | conserved


def compared_lines(rows: Sequence[StudyRow]) -> Lines:
    """The lines that have errors."""
    schemes = schemes_of(rows)
    compared = [row for row in rows if "thickness_l2" in row]
    return {
        spoken(family, scheme, schemes): sorted(line, key=lambda row: -float(row["spacing_km"]))
        for (family, scheme), line in lines_of(compared).items()
    }


def finest_rows(lines: Lines) -> dict[str, StudyRow]:
    """Rows of the largest number of cells asked for, by line; lines whose run failed there are missing."""
    most = max(row["requested_cells"] for line in lines.values() for row in line)
    return {name: row for name, line in lines.items() for row in line if row["requested_cells"] == most}


def best_mesh(rows: dict[str, StudyRow]) -> list[str]:
    """Which line has the smallest errors, by what factor, and whether other errors agree; rows are of one size."""
    asked = next(iter(rows.values()))["requested_cells"]
    if len(rows) == 1:
        name, row = next(iter(rows.items()))
        return [
            f"At {asked} cells there are results of {name} alone, so there is nothing to compare it with: its l2 error "
            f"of thickness is {number(row['thickness_l2'])}."
        ]
    found = ranking(rows, f"At {asked} cells")
    cells = sorted({int(each["cells"]) for each in rows.values()})
    if len(cells) > 1:
        found.append(f"These meshes have from {cells[0]} to {cells[-1]} cells, so weigh their costs too.")
    return found


def orders_in_words(lines: Lines, accepted_order: float | None) -> list[str]:
    """A sentence on the order of each line in the l2 error of thickness, or that none can be told."""
    found, single = [], []
    for name, line in lines.items():
        usable = [row for row in line if row["thickness_l2"] > ROUND_OFF]
        if len({row["spacing_km"] for row in usable}) < 2:
            single.append(name)
        else:
            found.append(_order_of(name, usable, accepted_order))
    if single:
        found.append(f"There is one size of mesh for {listed(single)}, so no order can be told.")
    return found


def _order_of(name: str, line: Sequence[StudyRow], accepted_order: float | None) -> str:
    spacing, error = ([float(row[column]) for row in line] for column in ("spacing_km", "thickness_l2"))
    order = fitted_order(spacing, error)
    told = f"The error of {name} has {order_in_words(spacing, error)}{_judged(order, accepted_order)}"
    rising = [(a["cells"], b["cells"]) for a, b in pairwise(line) if b["thickness_l2"] >= a["thickness_l2"]]
    if rising:
        told += f"; it does not fall {listed(f'from {a} to {b} cells' for a, b in rising)}"
    uncertainty = uncertainty_of(line[-1], "thickness_l2")
    if error[-1] < 2.0 * uncertainty:
        told += f"; the last is near the uncertainty of the reference, {number(uncertainty)}, so trust this order less"
    return f"{told}."


def _judged(order: float, accepted_order: float | None) -> str:
    """Whether an order is the one to expect; empty where the case does not say what to expect.

    Theory holds of smooth flows; a case that accepts a lower order than it is not smooth, and is held to its own.
    """
    if accepted_order is None:
        return ""
    if accepted_order >= EXPECTED_ORDER - ORDER_TOLERANCE:
        return f", {compared_with_theory(order, EXPECTED_ORDER, ORDER_TOLERANCE, 'second order')}"
    side = "below" if order < accepted_order else "not below"
    return f", {side} the {accepted_order:g} that is accepted of this case, which is not smooth enough for second order"


def stalling(lines: Lines) -> list[str]:
    """A sentence for each line whose largest error of thickness no longer falls with its l2 norm."""
    sentences = []
    for name, line in lines.items():
        last = line[-2:]
        spacing = [row["spacing_km"] for row in last]
        l2, linf = (fitted_order(spacing, [row[f"thickness_{norm}"] for row in last]) for norm in ("l2", "linf"))
        if l2 - linf > STALLING:
            worst = last[-1]
            sentences.append(
                f"On {name}, l∞ of thickness stalls between {last[0]['cells']} and {worst['cells']} cells at "
                f"{worst['thickness_linf']:.2g} (order {linf:.2f}, of l2 {l2:.2f}){_near_irregular(worst)}."
            )
    return sentences


def _near_irregular(row: StudyRow) -> str:
    """How near the worst cell is to an irregular one, if there are any."""
    if "worst_to_irregular" not in row:
        return ""
    away = f"{row['worst_to_irregular']:.1f} mean distances"
    return f": the worst cell is {away} from the nearest cell that is no hexagon"


def costs(lines: Lines) -> list[str]:
    """Which line reaches a given error with the fewest cells times steps; the error is one that all lines reach."""
    if len(lines) == 1:
        return [_cost_of_one(*next(iter(lines.items())))]
    if any(len(line) < 2 for line in lines.values()):
        return [_costs_at_one_size(finest_rows(lines))]
    wanted = max(min(float(row["thickness_l2"]) for row in line) for line in lines.values())
    within = {name: cost_of_error(line, wanted) for name, line in lines.items()}
    known = {name: cost for name, cost in within.items() if cost is not None}
    below = [name for name in lines if name not in known]
    found = [f"An l2 error of thickness of {number(wanted)} is one that every line reaches.", *_cheapest(known)]
    if below:
        coarsest, are = ("mesh", "is") if len(below) == 1 else ("meshes", "are")
        found.append(f"Even the coarsest {coarsest} of {listed(below)} {are} below it.")
    return [*found, COUNTED]


COUNTED = "Cost is cells times steps, whatever the machine."
SAME_WORK = "The work in a step of either scheme counts the same."


def cost_of_error(line: Sequence[StudyRow], error: float) -> float | None:
    """Cells times steps at which a line has this error, between its sizes; None if it is beyond them."""
    points = sorted((float(row["thickness_l2"]), float(row["cells"]) * float(row["steps"])) for row in line)
    errors, cost = np.log(np.array(points)).T
    if not errors[0] <= np.log(error) <= errors[-1]:
        return None
    return float(np.exp(np.interp(np.log(error), errors, cost)))


def _cheapest(known: dict[str, float]) -> list[str]:
    ranked = sorted(known, key=lambda name: known[name])
    least = known[ranked[0]]
    cheap = [name for name in ranked if are_equal(known[name], least)]
    ends = [f"{name} {times(known[name] / least)} as much" for name in ranked if name not in cheap]
    costs_what = "costs" if len(cheap) == 1 else "cost equally much,"
    rest = f"; {listed(ends)}" if ends else ""
    return [f"It {costs_what} {number(least)} cells times steps with {listed(cheap)}{rest}."]


def _cost_of_one(name: str, line: Sequence[StudyRow]) -> str:
    last = line[-1]
    return (
        f"The finest mesh of {name} costs {number(last['cells'] * last['steps'])} cells times steps for an l2 error of "
        f"thickness of {number(last['thickness_l2'])}; there is no other line to compare it with."
    )


def _costs_at_one_size(rows: dict[str, StudyRow]) -> str:
    ranked = sorted(rows, key=lambda name: float(rows[name]["cells"] * rows[name]["steps"]))
    spent = listed(f"{name} {number(rows[name]['cells'] * rows[name]['steps'])}" for name in ranked)
    return (
        f"Cells times steps: {spent}. The cost of an equal error cannot be told: not every line has two sizes of mesh."
    )


def _conserved(rows: Sequence[StudyRow]) -> list[str]:
    """The largest changes of the invariants over all runs."""
    finished = [row for row in rows if CONSERVATION[0] in row]
    if not finished:
        return ["No run came to its end, so nothing is known."]
    largest = (
        f"{name.removesuffix('_change').replace('_change_of_total', '').replace('_', ' ')} "
        f"{number(max(row[name] for row in finished))}"
        for name in CONSERVATION
    )
    return [f"The largest relative change in {counted(len(finished), 'run', 'runs')}: {listed(largest)}."]


def _failures(rows: Sequence[StudyRow]) -> list[str]:
    failed = [row for row in rows if row.get("failure")]
    if not failed:
        return []
    schemes = schemes_of(rows)
    where = listed(f"{spoken(row['family'], row['scheme'], schemes)} at {row['cells']} cells" for row in failed)
    return [f"{len(failed)} of {counted(len(rows), 'run', 'runs')} failed: {where}."]
