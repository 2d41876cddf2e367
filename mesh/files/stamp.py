"""The stamp of a mesh file that trisk has written: the hash of the mesh when it passed validation, and by which rules.

Whoever finds arrays of that hash in the file needs not validate them again. Any other file is validated in full, so a
stamp that does not fit does no harm.
"""

import netCDF4

from mesh.discrete.validate import RULES

HASH, RULES_NAME = "validated_hash", "validated_rules"
"""Global attributes: `mesh.files.io.mesh_hash` of all arrays and the radius, and the version of the rules."""


def stamp_attributes(identity: str) -> dict[str, object]:
    """Global attributes of a file whose mesh, of the hash `identity`, has passed validation without a warning."""
    return {HASH: identity, RULES_NAME: RULES}


def stamp_of(file: netCDF4.Dataset) -> str:
    """The hash in the stamp of an open file, empty where it has none or was validated by other rules."""
    rules = getattr(file, RULES_NAME, None)
    return str(getattr(file, HASH, "")) if str(rules) == str(RULES) else ""
