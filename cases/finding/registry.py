"""The cases by name, and cases in users' files by address; `docs/cases.md` has an example."""

from collections.abc import Mapping

from cases.base import Case
from cases.basins import KelvinWave, Seiche
from cases.case_file import is_address, load_case
from cases.galewsky import Galewsky
from cases.gyres import DoubleGyre, Stommel
from cases.hollingsworth import Hollingsworth
from cases.lake_at_rest import LakeAtRest
from cases.munk import Munk
from cases.parameters import Value, with_parameters
from cases.plane.adjustment import GeostrophicAdjustment
from cases.plane.base import PlaneCase
from cases.plane.channel import KelvinChannel
from cases.plane.gyres import MunkBox, StommelBox
from cases.plane.manufactured import Manufactured
from cases.plane.vortices import DualVortex
from cases.plane.waves import InertiaGravityWave
from cases.williamson import Williamson1, Williamson2, Williamson5, Williamson6
from swe.errors import InputError

CASES: dict[str, type[Case]] = {
    case.name: case
    for case in (
        *(Williamson1, Williamson2, Williamson5, Williamson6, Galewsky, LakeAtRest, Hollingsworth),
        *(Stommel, Munk, KelvinWave, Seiche, DoubleGyre),
    )
}


PLANE_CASES: dict[str, type[PlaneCase]] = {
    case.name: case
    for case in (
        *(InertiaGravityWave, Manufactured, GeostrophicAdjustment, DualVortex),
        *(StommelBox, MunkBox, KelvinChannel),
    )
}
"""The cases on planes."""


def find_case(name: str, parameters: Mapping[str, Value] | None = None) -> Case:
    """Return the case called `name`, or that at an address FILE.py:CLASS, with `parameters` where they are given.

    Other parameters are as in the paper. Values may be text, as typed on a command line; "case" and "parameters" in the
    record of a run give back its case. Raises `InputError` for an unknown case or parameter.
    """
    return with_parameters(_default_case(name), parameters or {})


def _default_case(name: str) -> Case:
    if is_address(name):
        return load_case(name)
    known: dict[str, type[Case]] = {**CASES, **PLANE_CASES}
    if name not in known:
        raise InputError(
            f"there is no case named '{name}'; choose one of {', '.join(known)}, or FILE.py:CLASS for one of your own"
        )
    return known[name]()
