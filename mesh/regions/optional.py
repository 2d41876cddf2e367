"""Packages of the extra `coast`, which few commands need."""

from importlib import import_module
from typing import Any

from mesh.errors import MeshError


def package_for_coasts(name: str, needed_for: str) -> Any:
    """The package `name`; raise `MeshError` that says how to install it, and what it is `needed_for`, if missing."""
    try:
        return import_module(name)
    except ImportError as error:
        raise MeshError(f"{needed_for} needs {name}, which is not installed; pip install 'trisk[coast]'") from error
