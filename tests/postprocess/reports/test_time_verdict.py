"""Verdicts on made-up tables of a study of time steps."""

from postprocess.reports.time_verdict import time_verdict
from postprocess.studies.study_folder import StudyRow
from postprocess.studies.time_study import time_figure


def rows_of(drift: float = 1e-9, scheme: str = "ringler2010", order: int = 5) -> list[StudyRow]:
    rows: list[StudyRow] = [
        {
            "time_step_s": 150.0 * 2**number,
            "scheme": scheme,
            "failure": "",
            "steps": 800 // 2**number,
            "courant_number": 0.2 * 2**number,
            "total_energy_change_of_total": -drift * 2 ** (order * number),
        }
        for number in range(3)
    ]
    for number, row in enumerate(rows[1:]):
        row |= {"thickness_difference_l2": 1e-6 * 16**number, "velocity_difference_l2": 2e-15}
    return rows


def test_orders_longest_step_and_gain() -> None:
    failed: StudyRow = {"time_step_s": 1200.0, "scheme": "ringler2010", "failure": "blown up"}
    assert time_verdict([*rows_of(), failed]) == {
        "Which time steps ran": [
            "The longest step that ran to the end is 600 s, of a largest Courant number of 0.80; 1 run of 4 failed, "
            "with 1200 s."
        ],
        "Which order": [
            "The drift of total energy has order 5.00 (5.00 to 5.00 between successive steps), the fifth order that "
            "theory expects.",
            "The difference in thickness from the run with 150 s has order 4.00 (from two steps alone, so its spread "
            "is not known), the fourth order that theory expects.",
            "The difference in velocity from the run with 150 s is at round-off at every step, so it shows no order.",
            "The run with 150 s has an error of its own, so orders of differences from it come out too high, by 0.09 "
            "where they are 4.",
        ],
        "What a longer step gains": [
            "The step of 600 s needs 0.25 times the steps of 150 s, and its thickness differs by 1.6e-05 (l2)."
        ],
    }
    lower = time_verdict(rows_of(order=3))["Which order"][0]
    assert lower.endswith("below the fifth order that theory expects.")


def test_schemes_are_set_side_by_side() -> None:
    verdict = time_verdict([*rows_of(), *rows_of(2e-9, "consistent")])
    assert verdict["Which scheme drifts less"] == [
        "At 600 s total energy drifts least with ringler2010, by 1.02e-06; with consistent 2.0 times as much."
    ]
    assert verdict["Which time steps ran"][1].startswith("With consistent, the longest step")


def test_all_runs_failed() -> None:
    rows = [{"time_step_s": step, "scheme": "ringler2010", "failure": "blown up"} for step in (600.0, 1200.0)]
    verdict = time_verdict(rows)
    assert verdict["Which time steps ran"] == ["Both runs failed."]
    one, three = (time_verdict(rows_failed)["Which time steps ran"] for rows_failed in (rows[:1], [*rows, rows[0]]))
    assert (one, three) == (["The one run failed."], ["All 3 runs failed."])
    assert verdict["What a longer step gains"] == ["Too few runs came to their end to compare steps."]
    assert (
        verdict["Which order"][0]
        == "Of the drift of total energy there are too few values above round-off (0) to tell an order."
    )


def test_the_figure_names_the_steps() -> None:
    axes = time_figure(rows_of(), "Heading").axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["150", "300", "600"]
