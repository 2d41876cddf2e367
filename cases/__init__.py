"""Test cases: parameters, initial state and, where it is known, exact solution; one module per paper."""

from cases.base import Case, parameter
from cases.galewsky import Galewsky
from cases.hollingsworth import Hollingsworth
from cases.lake_at_rest import LakeAtRest
from cases.registry import CASES, find_case
from cases.williamson import Williamson1, Williamson2, Williamson5, Williamson6

__all__ = [
    "CASES",
    "Case",
    "Galewsky",
    "Hollingsworth",
    "LakeAtRest",
    "Williamson1",
    "Williamson2",
    "Williamson5",
    "Williamson6",
    "find_case",
    "parameter",
]
