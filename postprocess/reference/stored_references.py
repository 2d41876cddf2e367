"""Which cases have a spectral reference that comes with the package; this needs no optional package."""

from pathlib import Path

from cases.finding.registry import CASES

FOLDER = Path(__file__).parent / "stored"
"""Folder of the references that come with the package."""


def stored_path(case: str) -> Path | None:
    """The reference file of the case of that name; None for a user's own case or if there is no file."""
    if case not in CASES:
        return None
    path = FOLDER / f"{case}.nc"
    return path if path.is_file() else None
