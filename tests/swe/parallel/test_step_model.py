"""The model of a step: what it counts is what runs send, and each cause adds the time that it should."""

from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mesh import Partition, VoronoiMesh
from mesh.partition.cell_graph import cell_graph
from swe.configuration import Options
from swe.parallel.exchange_counts import ExchangeCounts, count_exchanges
from swe.parallel.step_model import Machine, Network, StepTime, resized, rounds_of_reduction, step_pattern, step_time
from swe.run.composition import rings_needed
from tests.swe.parallel.short_run import blocks_by_longitude
from tests.swe.parallel.test_mpi import results
from tests.under_mpiexec import needs_mpi

RUNS: list[tuple[dict[str, Any], int, int]] = [
    ({}, 1, 3),
    ({"integrator": "rrk4"}, 1, 3),
    ({"integrator": "fbrk3"}, 1, 3),
    ({"integrator": "fbrk3"}, 3, 1),
    ({"integrator": "rfbrk3"}, 1, 3),
]
"""Options, calls of the stepper, and steps in each."""

WITH_DISSIPATION: list[tuple[dict[str, Any], int, int]] = [
    ({"dissipation": 1e15}, 1, 3),
    ({"integrator": "fbrk3", "dissipation": 1e15}, 1, 3),
    ({"integrator": "rrk4", "dissipation": 1e15, "scheme": "consistent"}, 1, 3),
]


def require_counted(
    mesh: VoronoiMesh, processes: int, runs: list[tuple[dict[str, Any], int, int]], folder: Path
) -> None:
    """Messages, bytes and reductions of runs are those of the model."""
    jobs = [{"kind": "count", "options": options, "calls": calls, "steps": steps} for options, calls, steps in runs]
    partition = Partition(blocks_by_longitude(mesh, processes), processes)
    for (options, calls, steps), found in zip(runs, results(processes, mesh, jobs, folder), strict=True):
        counts = count_exchanges(cell_graph(mesh), mesh.cells_on_edge, partition, rings_needed(Options(**options)))
        pattern = step_pattern(options.get("integrator", "rk4"), int("dissipation" in options), steps)
        exchanges = round(calls * steps * pattern.passes)
        assert found["loops"] == "fused"
        assert found["messages"] == (exchanges * counts.neighbours).tolist(), options
        assert found["bytes"] == (exchanges * counts.bytes_sent).tolist(), options
        assert min(found["bytes"]) > 0
        # Steps of one call ask once each, whatever the number of calls.
        assert found["reductions"] == [calls * steps * pattern.reductions] * processes, options


@pytest.mark.slow
@needs_mpi
@pytest.mark.parametrize("processes", [2, 3])
def test_runs_send_what_the_model_counts(icosahedral_mesh: VoronoiMesh, processes: int, tmp_path: Path) -> None:
    require_counted(icosahedral_mesh, processes, RUNS, tmp_path)


@needs_mpi
@pytest.mark.slow
def test_other_runs_send_what_the_model_counts(icosahedral_mesh: VoronoiMesh, tmp_path: Path) -> None:
    require_counted(icosahedral_mesh, 3, WITH_DISSIPATION, tmp_path)


def counts_of(own: list[float], halo: list[float], neighbours: list[int], sent: list[float]) -> ExchangeCounts:
    """Parts that compute `halo` cells of others, half of those that they have."""
    arrays = [np.array(values) for values in (own, 2 * np.array(halo), halo, neighbours, sent)]
    return ExchangeCounts(*arrays, values_received=arrays[4][::-1])


COUNTS = counts_of([90, 110, 100, 100], [10, 10, 50, 20], [2, 3, 3, 2], [5, 6, 7, 8])


def test_each_cause_takes_its_time() -> None:
    """By hand: the third part is the slowest, and its time is all that counts."""
    network, machine = Network(latency=2.0, bandwidth=4.0), Machine(10.0, seconds_per_pass=3.0, seconds_per_byte=0.25)
    found = step_time(COUNTS, step_pattern("rk4"), machine, network)
    assert found == StepTime(
        compute=1000.0,
        imbalance=0.0,
        halo=500.0,
        overhead=4 * (3.0 + 8 * 7 * 0.25),
        latency=4 * 3 * 2.0,
        volume=4 * 8 * 7 / 4.0,
        reductions=4.0,
    )
    assert found.total == 1652.0
    assert found.efficiency == 1000.0 / 1652.0
    unequal = step_time(
        replace(COUNTS, halo_cells_computed=np.array([1, 1, 1, 1])), step_pattern("rk4"), machine, network
    )
    assert (unequal.imbalance, unequal.halo) == (100.0, 10.0)
    few_cells = replace(machine, seconds_per_cell=1e-3)
    many_bytes = step_time(COUNTS, step_pattern("rk4"), few_cells, network)
    assert (many_bytes.latency, many_bytes.volume) == (4 * 2 * 2.0, 4 * 8 * 8 / 4.0)
    many_messages = step_time(COUNTS, step_pattern("rk4"), few_cells, replace(network, latency=100.0))
    assert (many_messages.latency, many_messages.volume) == (4 * 3 * 100.0, 4 * 8 * 7 / 4.0)


def test_what_is_received_may_take_longer_than_what_is_sent() -> None:
    one_way = replace(counts_of([100, 100], [10, 10], [1, 1], [5, 9]), values_received=np.array([11, 3]))
    found = step_time(one_way, step_pattern("rk4"), Machine(1.0), Network(0.0, 1.0))
    assert found.volume == 4 * 8 * 11


def test_a_process_alone_only_computes() -> None:
    alone = counts_of([100], [0], [0], [0])
    found = step_time(alone, step_pattern("rrk4"), Machine(1.0, 1.0, 1.0), Network())
    assert [getattr(found, field.name) for field in fields(found)] == [100.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    assert found.efficiency == 1.0


@pytest.mark.parametrize(
    ("processes", "rounds"), [(1, 0), (2, 1), (3, 3), (4, 2), (5, 4), (8, 3), (1024, 10), (10000, 15)]
)
def test_rounds_of_a_reduction(processes: int, rounds: int) -> None:
    assert rounds_of_reduction(processes) == rounds


def test_longer_calls_of_forward_backward_steps_repeat_fewer_passes() -> None:
    assert [step_pattern("fbrk3", steps_per_call=steps).passes for steps in (1, 2, 4)] == [4.0, 3.5, 3.25]
    assert step_pattern("rfbrk3", steps_per_call=4).passes == 4.0
    assert step_pattern("fbrk3", 1, steps_per_call=4).passes == 5.0
    assert step_pattern("rk4", 2, steps_per_call=4).passes == 6.0


def test_resized_parts_keep_their_spread(icosahedral_mesh: VoronoiMesh) -> None:
    """Twice as many cells in the means are twice as many in every part; neighbours stay."""
    large = ExchangeCounts(
        own_cells=2 * COUNTS.own_cells[:2],
        halo_cells=np.array([45, 45]),
        halo_cells_computed=np.array([30, 30]),
        neighbours=np.array([1, 1]),
        values_sent=np.array([26, 26]),
        values_received=np.array([13, 13]),
    )
    found = resized(COUNTS, large)
    np.testing.assert_allclose(found.own_cells, 2 * COUNTS.own_cells)
    np.testing.assert_allclose(found.halo_cells, COUNTS.halo_cells)
    np.testing.assert_allclose(found.halo_cells_computed, COUNTS.halo_cells_computed * 30 / 22.5)
    np.testing.assert_allclose(found.values_sent, 4 * COUNTS.values_sent)
    np.testing.assert_allclose(found.values_received, 2 * COUNTS.values_received)
    np.testing.assert_array_equal(found.neighbours, COUNTS.neighbours)
    assert found.n_parts == 4
    compact = replace(COUNTS, halo_cells_computed=np.zeros(4, np.int64))
    assert resized(compact, large).halo_cells_computed.tolist() == [30.0] * 4
