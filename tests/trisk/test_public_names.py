"""`import trisk` has what the packages give, and brings none of them before it is asked for."""

import subprocess
import sys

import pytest

import cases
import mesh
import postprocess
import swe
import trisk


def test_names_are_those_of_the_packages() -> None:
    assert trisk.__all__ == sorted([*mesh.__all__, *swe.__all__, *cases.__all__, *postprocess.__all__])
    assert set(trisk.__all__) <= set(dir(trisk))
    for package in (mesh, swe, cases, postprocess):
        for name in package.__all__:
            assert getattr(trisk, name) is getattr(package, name)


def test_packages_wait_until_they_are_asked_for() -> None:
    program = (
        "import sys, trisk\n"
        "packages = {'mesh', 'swe', 'cases', 'postprocess', 'numpy', 'numba', 'matplotlib', 'xarray'}\n"
        "assert not packages & set(sys.modules)\n"
        "assert trisk.scvt_mesh(42).n_cells == 42\n"
        "assert 'swe' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)


def test_an_unknown_name_is_told_with_the_known_ones() -> None:
    with pytest.raises(
        AttributeError, match=r"module 'trisk' has no attribute 'scvt'; it has CASES, Callback, Case, .*scvt_mesh"
    ):
        trisk.scvt  # noqa: B018


def test_the_first_run_in_six_lines() -> None:
    grid = trisk.scvt_mesh(162)
    simulation = trisk.Simulation(grid, trisk.Williamson2(), time_step=1800.0)
    simulation.run(days=0.5, progress=False)
    assert simulation.time == 43200.0
