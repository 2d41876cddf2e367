"""The public names of all packages, loaded when first used, so that `import trisk` is quick."""

import importlib
from typing import Any

_PLACES = {
    "mesh": (
        *("MeshError", "MeshRequest", "MeshWarning", "Operators", "Partition", "Quality", "Region", "VoronoiMesh"),
        *("build_operators", "cull_mesh", "find_region", "hexagon_mesh", "mesh_from_points", "mesh_on_plane"),
        *(
            "mesh_quality",
            "normal_component",
            "partition_mesh",
            "periodic_mesh",
            "polygon_mesh",
            "read_mesh",
            "region_mesh",
            "scvt_mesh",
            "validate_mesh",
            "write_mesh",
        ),
    ),
    "swe": (
        *("Callback", "Forcing", "InputError", "LinearDrag", "QuadraticDrag", "RunError", "ShallowWaterModel"),
        *("Simulation", "State", "ThicknessRelaxation", "Viscosity", "WindStress"),
    ),
    "cases": (
        *("CASES", "Case", "DoubleGyre", "DualVortex", "Galewsky", "GeostrophicAdjustment", "Hollingsworth"),
        *("InertiaGravityWave", "KelvinChannel", "KelvinWave", "LakeAtRest", "Manufactured", "Munk", "MunkBox"),
        *("PLANE_CASES", "PlaneCase", "Seiche", "Stommel", "StommelBox"),
        *("Williamson1", "Williamson2", "Williamson5", "Williamson6", "find_case", "parameter"),
    ),
    "postprocess": ("compare_runs", "open_run", "plot_field"),
}
_PACKAGE_OF = {name: package for package, names in _PLACES.items() for name in names}

__all__ = sorted(_PACKAGE_OF)


def __getattr__(name: str) -> Any:
    if name not in _PACKAGE_OF:
        raise AttributeError(f"module 'trisk' has no attribute {name!r}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module(_PACKAGE_OF[name]), name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
