"""Test cases: parameters, initial and, where known, exact state; one paper a module."""

from cases.base import Case
from cases.registry import CASES, find_case
from cases.williamson import Williamson2, Williamson5

__all__ = ["CASES", "Case", "Williamson2", "Williamson5", "find_case"]
