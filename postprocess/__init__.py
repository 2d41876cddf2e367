"""Reading runs back, comparing them and drawing them; public names are brought when they are asked for."""

import importlib
from typing import Any

_PLACES = {
    "compare_runs": "postprocess.compare.comparison",
    "open_run": "postprocess.interactive.opened_run",
    "plot_field": "postprocess.figures.field_map",
}

__all__ = sorted(_PLACES)


def __getattr__(name: str) -> Any:
    if name not in _PLACES:
        raise AttributeError(f"module 'postprocess' has no attribute {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(_PLACES[name]), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
