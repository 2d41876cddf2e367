"""Everything that is compiled, run once: python tests/reliability/exercise_kernels.py RESULTS.npz [checked].

With `checked`, kernels are compiled anew, on one thread, with tests of every index against the bounds of its array:
numba raises no errors from parallel loops. With NUMBA_DISABLE_JIT=1 in the environment they are run as Python. What the
kernels compute goes to RESULTS.npz, to be compared; the names of those that were not called are printed.
"""

import dataclasses
import functools
import importlib
import pkgutil
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numba
import numpy as np

PACKAGES = ("mesh", "swe", "cases", "postprocess")


def compile_checked() -> None:
    """Have `numba.njit` make kernels that test indices, from now on."""
    original = numba.njit

    @functools.wraps(original)
    def checked(*arguments: Any, **options: Any) -> Any:
        options = {name: value for name, value in options.items() if name not in ("parallel", "cache")}
        return original(*arguments, **options, boundscheck=True)

    numba.njit = checked


def exercise() -> dict[str, np.ndarray]:
    """Make meshes by every method, and run every scheme on a regular and an irregular one."""
    from cases import Williamson1, Williamson5
    from mesh import mesh_from_points, mesh_quality, scvt_mesh
    from mesh.density.gridded import find_density
    from mesh.density.named import uniform
    from mesh.density.scattered import density_from_cells
    from mesh.discrete.operators import velocity_at_cells
    from mesh.discrete.topology import FILL
    from mesh.discrete.validate import validate_mesh
    from mesh.generation import multilevel
    from mesh.generation.nested import nested_scvt
    from mesh.generation.optimizer import Limits
    from mesh.generation.well_centered import well_center
    from mesh.geometry.sphere import fibonacci_points
    from mesh.voronoi_mesh import TOPOLOGY_NAMES
    from swe import ShallowWaterModel, Simulation
    from swe.diagnostics.budgets import measure_rates
    from swe.equations.anticipation import Anticipation
    from swe.equations.dissipation import BiharmonicDissipation
    from swe.stepping.time_stepping import RungeKutta

    multilevel.SERIAL_LIMIT = 10  # so that its parallel loops are called too
    found: dict[str, np.ndarray] = {}
    random = np.random.default_rng(2)
    regular = scvt_mesh(42, method="multilevel")
    irregular = mesh_from_points(random.normal(size=(60, 3)))
    nested = nested_scvt(
        regular.cell_points, regular.cells_on_vertex, find_density("refined-circle"), limits=Limits(1e-1)
    )
    others = {
        "multilevel": scvt_mesh(162, method="multilevel", tolerance=1e-3),
        "nested": mesh_from_points(nested.points, nested.triangles),
        "lloyd": scvt_mesh(32, start="fibonacci", method="lloyd", tolerance=5e-2),
        "macqueen": scvt_mesh(32, start="random", method="macqueen", tolerance=0.3),
        "density": scvt_mesh(40, density="smooth-transition", start="fibonacci", tolerance=1e-2),
    }
    others["well-centred"] = mesh_from_points(
        well_center(others["lloyd"].cell_points, others["lloyd"].cells_on_vertex, uniform).points
    )
    interpolate = density_from_cells(irregular.cell_points, random.random(60), irregular.cells_on_vertex)
    found["interpolation between cells"] = interpolate(fibonacci_points(50))
    for name, mesh in {"regular": regular, "irregular": irregular, **others}.items():
        validate_mesh(mesh)
        found[f"quality of {name}"] = np.array(list(vars(mesh_quality(mesh)).values()), float)
    for name, mesh in (("regular", regular), ("irregular", irregular)):
        schemes: dict[str, dict[str, Any]] = {
            "rk4": {},
            "rrk4": {"integrator": "rrk4"},
            "damped": {"anticipation": 0.5, "dissipation": 1e12},
        }
        for scheme, options in schemes.items():
            with tempfile.TemporaryDirectory() as folder:
                simulation = Simulation(
                    mesh, Williamson5(), Path(folder), time_step=30.0, diagnostics_interval=60.0, **options
                )
                simulation.run(days=90.0 / 86400.0, progress=False)
            found[f"{scheme} h on {name}"] = simulation.state.thickness
            found[f"{scheme} u on {name}"] = simulation.state.normal_velocity
        plain = Simulation(mesh, Williamson5())
        RungeKutta(plain.model.tendency, plain.state).advance(plain.state, 30.0, 3)
        found[f"plain h on {name}"] = plain.state.thickness
        # What fills short rings must not be read: as -1 it would be taken for the last entity, beyond all it is found.
        beyond = {
            field: np.where(values == FILL, np.int32(2**31 - 1), values)
            for field in TOPOLOGY_NAMES
            if (values := getattr(plain.mesh, field)).ndim == 2
        }
        filled = dataclasses.replace(plain.mesh, **beyond)
        terms = [Anticipation(filled, 100.0), BiharmonicDissipation(filled, 1e12)]
        before = plain.model
        model = ShallowWaterModel(filled, before.topography, before.coriolis, before.gravity, terms=terms)
        state, tendency = plain.state.copy(), plain.state.empty_like()
        RungeKutta(model.tendency, state).advance(state, 30.0)
        model.tendency(state, tendency)
        diagnosis = model.diagnose(state)
        rates = measure_rates(model, state, diagnosis, tendency)
        found[f"filled h on {name}"] = state.thickness
        found[f"filled q on {name}"] = diagnosis.potential_vorticity
        found[f"filled enstrophy on {name}"] = np.array([rates["potential_enstrophy_rate_dissipation"]])
        found[f"filled wind on {name}"] = velocity_at_cells(filled, state.normal_velocity)[0]
        found[f"filled Courant number on {name}"] = np.array([model.courant_number(state, 30.0)])
        advected = Simulation(mesh, Williamson1(), time_step=60.0)
        advected.run(days=120.0 / 86400.0, progress=False)
        found[f"advected h on {name}"] = advected.state.thickness
    return found


def uncalled() -> list[str]:
    """Compiled functions of the packages that have not been called with any types."""
    functions = {
        f"{module.name}.{name}": value
        for package in PACKAGES
        for module in pkgutil.iter_modules(importlib.import_module(package).__path__, f"{package}.")
        for name, value in vars(importlib.import_module(module.name)).items()
        if isinstance(value, numba.core.dispatcher.Dispatcher) and value.__module__ == module.name
    }
    return [name for name, function in functions.items() if not function.signatures]


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    if sys.argv[2:] == ["checked"]:
        compile_checked()
    np.savez(sys.argv[1], **exercise())
    print("\n".join(uncalled()))
