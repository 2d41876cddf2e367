"""Verdicts on made-up tables of compared runs: known numbers in, exact sentences out."""

from pathlib import Path
from typing import Any

import pytest

from postprocess.reports.compare_report import names_of
from postprocess.reports.compare_verdict import NORMS, comparison_verdict
from postprocess.reports.ranking import DIFFERENCE, ERROR
from postprocess.studies.study_folder import StudyRow

EXACT = "the exact solution"


def row_of(run: str, error: float, day: float = 5.0, **more: Any) -> StudyRow:
    """A row whose norms are `error` and multiples of it."""
    return {
        "run": run,
        "cells": 642,
        "day": day,
        "thickness_l2": error,
        "thickness_linf": 3.0 * error,
        "vorticity_l2": 10.0 * error,
        "vorticity_linf": 20.0 * error,
        **more,
    }


def test_the_nearer_run_and_its_factor() -> None:
    verdict = comparison_verdict([row_of("coarse", 4e-3), row_of("fine", 1e-3)], EXACT, ERROR)
    assert verdict["Which run is nearer to the exact solution"] == [
        "On day 5 fine has the smallest l2 error of thickness, 0.001; that of coarse is 4.0 times as large.",
        "The same holds of the largest error of thickness and the error of vorticity.",
    ]
    assert verdict["How large the error is"] == [
        "coarse, of 642 cells, is off on day 5 in thickness by 0.4% (l2) and at most 1.2% (l∞) and vorticity by 4% "
        "(l2) and at most 8% (l∞).",
        "fine, of 642 cells, is off on day 5 in thickness by 0.1% (l2) and at most 0.3% (l∞) and vorticity by 1% (l2) "
        "and at most 2% (l∞).",
        NORMS,
    ]
    assert verdict["When the error grows"] == []
    assert verdict["Where the error lies"] == []


def test_another_norm_may_prefer_another_run() -> None:
    rows = [row_of("a", 1e-3, vorticity_l2=0.03), row_of("b", 2e-3), row_of("c", 3e-3)]
    told = comparison_verdict(rows, "runs/reference, 2562 cells", DIFFERENCE)
    assert told["Which run is nearest to runs/reference, 2562 cells"] == [
        "On day 5 a has the smallest l2 difference in thickness, 0.001; that of b is 2.0 times as large and that of c "
        "is 3.0 times as large.",
        "The same holds of the largest difference in thickness.",
        "By the difference in vorticity, b is best; that of a is 1.50 times as large.",
    ]


@pytest.mark.parametrize(("error", "equal"), [(1.04e-3, True), (1.06e-3, False)])
def test_within_five_percent_runs_are_equal(error: float, equal: bool) -> None:
    told = comparison_verdict([row_of("a", 1e-3), row_of("b", error)], EXACT, ERROR)
    sentence = told["Which run is nearer to the exact solution"][0]
    assert sentence == (
        "On day 5 the l2 errors of thickness of a and b, both about 0.001, are equal: they differ by less than 5%."
        if equal
        else "On day 5 a has the smallest l2 error of thickness, 0.001; that of b is 1.06 times as large."
    )


def test_days_on_which_levels_are_first_exceeded() -> None:
    errors = {"a": (5e-4, 2e-3, 8e-4, 0.2), "b": (0.05, 0.06, 0.07, 0.08), "c": (1e-6, 1e-5, 1e-4, 1e-3)}
    rows = [row_of(run, error, day) for run, line in errors.items() for day, error in enumerate(line, 1)]
    assert comparison_verdict(rows, EXACT, ERROR)["When the error grows"] == [
        "The l2 error of thickness of a is first above 0.1% on day 2 and above 1% and 10% on day 4, of the 4 days "
        "compared.",
        "The l2 error of thickness of b is first above 0.1% and 1% on day 1, and never above 10%, of the 4 days "
        "compared.",
        "The l2 error of thickness of c is never above 0.1% on the 4 days compared.",
    ]


def test_where_it_lies() -> None:
    shares = {"error_share_30n_to_60n": 0.6, "area_share_30n_to_60n": 0.183}
    told = comparison_verdict([row_of("a", 1e-3, 1.0), row_of("a", 1e-3, **shares)], "b, 642 cells", DIFFERENCE)
    assert told["Where the difference lies"] == [
        "Of the squared difference in thickness of a, 60% lie between 30°N and 60°N (18% of the area)."
    ]
    assert told["Which run is nearest to b, 642 cells"] == []


def test_runs_at_round_off() -> None:
    rows = [row_of("a", 0.0), row_of("b", 3e-16), row_of("c", 1e-3)]
    told = comparison_verdict(rows, "a, 642 cells", DIFFERENCE)
    assert told["Which run is nearest to a, 642 cells"] == [
        "On day 5 the l2 difference in thickness is at round-off for a and b; it is 0.001 for c."
    ]
    assert told["How large the difference is"][1] == (
        "b, of 642 cells, is off on day 5 in thickness by 3e-16 (l2) and at most 9e-16 (l∞) and vorticity by 3e-15 "
        "(l2) and at most 6e-15 (l∞)."
    )
    told = comparison_verdict(rows[:2], "a, 642 cells", DIFFERENCE)
    assert told["Which run is nearer to a, 642 cells"] == [
        "On day 5 the l2 difference in thickness is at round-off for a and b."
    ]


def test_norms_that_do_not_exist() -> None:
    rows = [row_of("a", 1e-3), row_of("b", 2e-3)]
    for row in rows:
        del row["thickness_l2"], row["thickness_linf"]
    told = comparison_verdict(rows, EXACT, ERROR)["Which run is nearer to the exact solution"]
    assert told[0] == "On day 5 a has the smallest l2 error of vorticity, 0.01; that of b is 2.0 times as large."
    assert comparison_verdict([{"run": "a", "cells": 642, "day": 5.0}], EXACT, ERROR) == {
        "How large the error is": ["The reference is zero everywhere, so no relative norm exists."]
    }


def test_the_uncertainty_of_the_reference_is_told() -> None:
    told = comparison_verdict([row_of("a", 1e-3, uncertainty_thickness=2e-4)], "spectral", ERROR)
    assert told["How large the error is"][1] == "The reference itself is uncertain by 0.02% in thickness (l2)."


def test_runs_are_called_by_their_folders_where_that_tells_them_apart() -> None:
    assert names_of([Path("study/one"), Path("study/two"), Path("study/one")]) == ["one", "two", "one"]
    assert names_of([Path("here/run"), Path("there/run")]) == ["here/run", "there/run"]
