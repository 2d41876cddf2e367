"""Options that several commands share."""

from typing import Annotated, Literal

import typer

CaseName = Annotated[
    str,
    typer.Argument(
        metavar="CASE", help="Name of a test case ('trisk cases' lists them), or FILE.py:CLASS with your own."
    ),
]
Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter of the case, such as angle=pi/2; repeatable."),
]
SCHEME_HELP = "ringler2010, that of the published results, or consistent, whose errors stay small on irregular meshes."
Scheme = Annotated[Literal["ringler2010", "consistent"], typer.Option("--scheme", help=SCHEME_HELP)]
Schemes = Annotated[
    list[str] | None,
    typer.Option(
        "--scheme",
        metavar="[ringler2010|consistent]",
        help=f"{SCHEME_HELP} Repeatable, for runs of both side by side; by default ringler2010.",
    ),
]
AnticipationFraction = Annotated[
    float,
    typer.Option(
        "--apvm",
        help="Fraction of a time step by which potential vorticity is anticipated (APVM); 0.5 in the literature.",
    ),
]
UpwindingFactor = Annotated[
    float,
    typer.Option(
        "--upwinding",
        help="How far potential vorticity is blended towards the value upstream, from 0 to 1; like --apvm, but "
        "whatever the time step.",
    ),
]
DissipationCoefficient = Annotated[
    float, typer.Option("--dissipation", help="Coefficient of biharmonic dissipation, m4/s.")
]
WallSlip = Annotated[
    float,
    typer.Option("--wall-slip", help="Slip along coasts, from 0 (no slip) to 1 (free slip: no vorticity at coasts)."),
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Show no progress and no summary.")]
Recompute = Annotated[
    bool,
    typer.Option("--recompute-metrics", help="Rebuild the file's lengths, areas and weights from its generators."),
]
FileFormat = Annotated[
    str, typer.Option("--format", help="netcdf4; for programs without HDF5, cdf5 or classic (with 64-bit offsets).")
]
