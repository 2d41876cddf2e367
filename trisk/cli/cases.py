"""`trisk cases`: the test cases and their parameters."""

from typing import Annotated

import typer


def cases(
    name: Annotated[
        str | None, typer.Argument(help="Name of a test case, or FILE.py:CLASS, to see its parameters.")
    ] = None,
) -> None:
    """List the test cases, or the parameters of one."""
    from cases import CASES, PLANE_CASES, find_case
    from trisk.report.case_table import print_case, print_cases

    if name is None:
        print_cases([find_case(known) for known in (*CASES, *PLANE_CASES)])
    else:
        print_case(find_case(name))
