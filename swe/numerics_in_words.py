"""What a run is computed with, as it shows itself: a simulation, and the run that it leaves."""

from collections.abc import Iterable, Mapping
from typing import Any

from mesh.shown import Rows, in_words

UNITS = {"dissipation": "m4/s"}
"""Of the options that are told; the others have none."""


def numerics_in_words(configuration: Mapping[str, Any], forcings: Iterable[str]) -> Rows:
    """Scheme and integrator, and the options that a configuration, as in `run.json`, has beyond the defaults.

    `forcings` are the names of the terms that the case adds.
    """
    rows = {
        "scheme": in_words(configuration.get("scheme", "ringler2010")),
        "integrator": in_words(configuration.get("integrator", "rk4")),
    }
    options = [
        f"{name.replace('_', ' ')} {in_words(configuration[name], UNITS.get(name, ''))}"
        for name in ("anticipation", "upwinding", "dissipation", "wall_slip")
        if configuration.get(name)
    ]
    return rows | {"options": ", ".join(options), "terms of the case": in_words(", ".join(map(str, forcings)))}
