"""Verdicts on made-up tables of a study of meshes: known numbers in, exact sentences out."""

from typing import Any

import pytest

from postprocess.compare.shares import BANDS
from postprocess.reports.mesh_verdict import best_mesh, compared_lines, cost_of_error, costs, finest_rows, mesh_verdict
from postprocess.reports.sentences import where_in_words, zone_in_words
from postprocess.studies.study_folder import StudyRow

SIZES = (642, 2562, 10242)


def rows_of(family: str, error: float, order: float, sizes: tuple[int, ...] = SIZES, **more: Any) -> list[StudyRow]:
    """Rows whose error falls with exactly this order from `error` on the first size."""
    return [
        {
            "family": family,
            "scheme": "ringler2010",
            "requested_cells": cells,
            "cells": cells,
            "spacing_km": 800.0 / 2**number,
            "thickness_l2": error / 2 ** (order * number),
            "thickness_linf": 3.0 * error / 2 ** (order * number),
            "steps": 100 * 2**number,
            "failure": "",
            **more,
        }
        for number, cells in enumerate(sizes)
    ]


def test_the_best_family_its_factor_and_orders() -> None:
    verdict = mesh_verdict([*rows_of("scvt", 4e-3, 2.0), *rows_of("bisection", 8e-3, 1.5)], 1.85)
    assert verdict["Which mesh is best"] == [
        "At 10242 cells scvt has the smallest l2 error of thickness, 0.00025; that of bisection is 4.0 times as large.",
        "The same holds of the largest error of thickness.",
    ]
    assert verdict["Which order"] == [
        "The error of scvt has order 2.00 (2.00 to 2.00 between successive sizes), the second order that theory "
        "expects.",
        "The error of bisection has order 1.50 (1.50 to 1.50 between successive sizes), below the second order that "
        "theory expects.",
    ]
    changed = mesh_verdict([*rows_of("scvt", 4e-2, 2.0), *rows_of("bisection", 8e-3, 1.5)])
    assert changed["Which mesh is best"][0].startswith("At 10242 cells bisection has the smallest")


@pytest.mark.parametrize(("error", "equal"), [(1.04e-3, True), (1.06e-3, False)])
def test_errors_within_five_percent_are_equal(error: float, equal: bool) -> None:
    rows = [*rows_of("scvt", 1e-3, 2.0, (642,)), *rows_of("random", error, 2.0, (642,))]
    sentence = best_mesh(finest_rows(compared_lines(rows)))[0]
    assert sentence == (
        "At 642 cells the l2 errors of thickness of scvt and random, both about 0.001, are equal: they differ by less "
        "than 5%."
        if equal
        else "At 642 cells scvt has the smallest l2 error of thickness, 0.001; that of random is 1.06 times as large."
    )


def test_the_uncertainty_of_the_reference_hides_differences() -> None:
    rows = [
        *rows_of("scvt", 1e-3, 2.0, (642,), uncertainty_thickness=1e-3),
        *rows_of("random", 1.5e-3, 2.0, (642,), uncertainty_thickness=1e-3),
    ]
    assert mesh_verdict(rows)["Which mesh is best"][0].endswith(
        "are equal: they differ by less than 5%, or by less than the uncertainty of the reference, 0.001."
    )


def test_one_mesh_shows_no_order_and_no_best() -> None:
    verdict = mesh_verdict(rows_of("scvt", 1e-3, 2.0, (642,)))
    assert verdict["Which mesh is best"] == [
        "At 642 cells there are results of scvt alone, so there is nothing to compare it with: its l2 error of "
        "thickness is 0.001."
    ]
    assert verdict["Which order"] == ["There is one size of mesh for scvt, so no order can be told."]


def test_orders_of_two_sizes_are_said_to_be_so() -> None:
    two = mesh_verdict(rows_of("scvt", 1e-3, 1.6, SIZES[:2]))["Which order"]
    assert two == ["The error of scvt has order 1.60 (from two sizes alone, so its spread is not known)."]


@pytest.mark.parametrize(
    ("accepted", "judged"),
    [
        (1.85, ", below the second order that theory expects."),
        (1.5, ", not below the 1.5 that is accepted of this case, which is not smooth enough for second order."),
        (1.7, ", below the 1.7 that is accepted of this case, which is not smooth enough for second order."),
        (None, " sizes)."),
    ],
)
def test_orders_are_judged_by_what_the_case_lets_expect(accepted: float | None, judged: str) -> None:
    sentence = mesh_verdict(rows_of("scvt", 1e-3, 1.6), accepted)["Which order"][0]
    assert sentence.endswith(judged)
    assert sentence.startswith("The error of scvt has order 1.60 (1.60 to 1.60 between successive sizes)")


def test_an_error_that_grows_is_told() -> None:
    rows = rows_of("scvt", 1e-3, 2.0)
    rows[2]["thickness_l2"] = 9e-4
    assert mesh_verdict(rows)["Which order"][0].endswith("; it does not fall from 2562 to 10242 cells.")


def test_the_largest_error_stalls() -> None:
    rows = rows_of("scvt", 1e-3, 2.0, worst_to_irregular=1.23)
    rows[2]["thickness_linf"] = rows[1]["thickness_linf"]
    assert mesh_verdict(rows)["Which order"][-1] == (
        "On scvt, l∞ of thickness stalls between 2562 and 10242 cells at 0.00075 (order 0.00, of l2 2.00): the worst "
        "cell is 1.2 mean distances from the nearest cell that is no hexagon."
    )


def test_cost_of_an_error_is_read_between_sizes() -> None:
    scvt, bisection = rows_of("scvt", 4e-3, 2.0), rows_of("bisection", 16e-3, 2.0)
    assert cost_of_error(scvt, 1e-3) == pytest.approx(2562 * 200)
    assert cost_of_error(scvt, 1e-9) is None
    assert costs({"scvt": scvt, "bisection": bisection})[:2] == [
        "An l2 error of thickness of 0.001 is one that every line reaches.",
        "It costs 5.12e+05 cells times steps with scvt; bisection 8.0 times as much.",
    ]
    consistent = [row | {"scheme": "consistent"} for row in bisection]
    told = [mesh_verdict(rows)["What it costs"] for rows in ([*scvt, *bisection], [*scvt, *consistent])]
    assert [sentences[-1] for sentences in told] == [
        "Cost is cells times steps, whatever the machine.",
        "The work in a step of either scheme counts the same.",
    ]
    below = costs({"scvt": rows_of("scvt", 1e-4, 2.0), "bisection": bisection})
    assert below[2] == "Even the coarsest mesh of scvt is below it."


def test_failures_and_runs_without_errors() -> None:
    rows = [
        {"family": "scvt", "scheme": "ringler2010", "cells": 642, "failure": "blown up"},
        {"family": "random", "scheme": "ringler2010", "cells": 642, "failure": ""},
    ]
    assert mesh_verdict(rows) == {
        "Which mesh is best": [
            "1 of 2 runs failed: scvt at 642 cells.",
            "No run has an error, so meshes cannot be compared.",
        ],
        "What is conserved": ["No run came to its end, so nothing is known."],
    }


def test_round_off_has_no_order() -> None:
    verdict = mesh_verdict(rows_of("scvt", 1e-15, 0.0))
    assert verdict["Which mesh is best"] == ["All errors are at round-off, so there is no best mesh and no order."]


def test_where_the_error_lives() -> None:
    row: StudyRow = {
        "error_share_30n_to_60n": 0.6,
        "area_share_30n_to_60n": 0.183,
        "error_share_near_irregular": 0.07,
        "area_share_near_irregular": 0.075,
        "error_share_transition": 0.16,
        "area_share_transition": 0.03,
    }
    assert where_in_words("scvt", row) == (
        "Of the squared error of scvt, 60% lie between 30°N and 60°N (18% of the area) and 16% lie at the transition "
        "of the refinement (3% of the area)."
    )
    spread = row | {"error_share_30n_to_60n": 0.2, "error_share_transition": 0.03}
    assert where_in_words("scvt", spread) == (
        "The squared error of scvt is spread: no band of latitude and no zone of the refinement holds 1.5 times its "
        "share of the area, and 7% of it are within two cells of one that is no hexagon (7.5% of the area)."
    )


def test_bands_are_said_as_on_a_map() -> None:
    words = ["south of 60°S", "between 60°S and 30°S", "between 30°S and the equator"]
    words += ["between the equator and 30°N", "between 30°N and 60°N", "north of 60°N"]
    assert [zone_in_words(band) for band in BANDS] == words
