"""Total energy over 15 days of test case 5 changes by the time truncation error alone."""

from cases import Williamson5
from mesh import VoronoiMesh
from swe import Simulation
from swe.diagnostics.invariants import Changes, relative_changes


def changes_after_fifteen_days(mesh: VoronoiMesh, time_step: float) -> Changes:
    simulation = Simulation(mesh, Williamson5(), time_step=time_step)
    simulation.run(days=15, progress=False)
    return relative_changes(simulation.initial_invariants, simulation.invariants)


def test_energy_drift_falls_with_the_time_step(larger_mesh: VoronoiMesh) -> None:
    coarse, fine = (changes_after_fifteen_days(larger_mesh, time_step) for time_step in (600.0, 300.0))
    assert -4.5e-9 < coarse.total_energy_of_total < -3.0e-9
    assert coarse.total_energy_of_total / fine.total_energy_of_total > 2.0**4.5
    for changes in (coarse, fine):
        assert abs(changes.mass) < 1e-12
        assert abs(changes.absolute_vorticity) < 1e-12
