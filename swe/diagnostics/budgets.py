"""Budgets: how fast each term of the discrete equations changes each of the global integrals.

With F_e = h_e u_e and the Bernoulli function B_i = g (h_i + b_i) + K_i, an acceleration a_e of the fluid changes total
energy by the sum of l_e d_e F_e a_e, absolute vorticity by that of the circulations C_v = sum_e t_ev d_e a_e and
potential enstrophy by that of q_v C_v; a thickness tendency dh_i changes total energy by the sum of A_i B_i dh_i and
potential enstrophy by that of -q_v^2/2 kite_vi dh_i. Thuburn et al. (2009) and Ringler et al. (2010) show which of the
terms cancel: the work of the Coriolis force cancels, and that of minus the gradient of B cancels the transport of B by
the mass flux. They do so to round-off.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.discrete.walls import boundary_vertices
from swe.diagnostics import integral_kernels
from swe.equations.model import Diagnosis, ShallowWaterModel
from swe.equations.terms import Term
from swe.parallel.folding import folded_sums
from swe.parallel.processes import anywhere
from swe.state import State

RATES = {
    "mass": ("m3 s-1", ("transport",)),
    "total_energy": ("m5 s-3", ("coriolis", "exchange", "dissipation")),
    "potential_enstrophy": ("m s-3", ("coriolis", "anticipation", "upwinding", "dissipation")),
    "absolute_vorticity": ("m2 s-2", ("coriolis", "gradient", "dissipation")),
}
"""For each integral the units of its rates and what changes it, besides the time step and the user's own terms."""

MEANINGS = {
    "transport": "by the divergence of the mass flux, zero but for round-off",
    "exchange": "by the gradient of the Bernoulli function and the mass flux, zero but for round-off",
    "gradient": "by the gradient of the Bernoulli function, zero but for round-off",
    "anticipation": "by the anticipation of potential vorticity",
    "upwinding": "by the upwinding of potential vorticity",
    "dissipation": "by biharmonic dissipation",
    "time": "since the row before, on the average, less the terms' mean of both rows: by the time step",
}
"""What each cause is, except the Coriolis force, whose effect on potential enstrophy does not vanish."""

CORIOLIS = {
    "total_energy": "by the work of the Coriolis force, zero but for round-off",
    "absolute_vorticity": "by the curl of the Coriolis force, zero but for round-off",
    "potential_enstrophy": "by the Coriolis force and the mass flux, that is by the advection of potential vorticity",
}


def rate_name(integral: str, term: str) -> str:
    """Name of a rate in the diagnostics file."""
    return f"{integral}_rate_{term}"


def rate_series(terms: Iterable[Term] = ()) -> dict[str, tuple[str, str]]:
    """Units and meaning of every rate, by name, for a model with these `terms`."""
    terms = tuple(terms)
    own = {term.name: term.meaning for term in terms}
    return {
        rate_name(integral, cause): (
            RATES[integral][0],
            f"rate of {integral.replace('_', ' ')} "
            + (CORIOLIS[integral] if cause == "coriolis" else {**own, **MEANINGS}[cause]),
        )
        for integral, causes in causes_of_change(terms).items()
        for cause in (*causes, "time")
    }


def causes_of_change(terms: Iterable[Term]) -> dict[str, tuple[str, ...]]:
    """For each integral what changes it in a model with these `terms`, besides the time step."""
    terms = tuple(terms)
    return {
        integral: (*causes, *(term.name for term in terms if integral in term.changes and term.name not in causes))
        for integral, (_, causes) in RATES.items()
    }


def measure_rates(
    model: ShallowWaterModel, state: State, diagnosis: Diagnosis, tendency: State, time: float = 0.0
) -> dict[str, float]:
    """Rates of the integrals at `state` and `time`, s, under the names of the diagnostics file.

    `diagnosis` belongs to `state`, and `tendency` is the one with which the run takes its steps, without terms that act
    after steps. Under a prescribed wind no force acts, and only the transport of mass and the terms have rates.
    """
    rates = dict.fromkeys((name for name in rate_series(model.terms) if not name.endswith("_time")), 0.0)
    bernoulli, q = np.empty(model.mesh.n_cells), diagnosis.potential_vorticity
    integral_kernels.bernoulli(state.thickness, model.topography, diagnosis.kinetic_energy, model.gravity, bernoulli)
    transport = _work_of_transport(model, tendency.thickness, bernoulli, q)
    rates["mass_rate_transport"] = transport.mass
    flux = np.empty(model.mesh.n_edges)
    model.scheme.flux(state.thickness, state.normal_velocity, flux)
    if not model.prescribed_wind:
        gradient, coriolis = _work_of_forces(model, flux, tendency.normal_velocity, bernoulli, q)
        rates["total_energy_rate_exchange"] = gradient.total_energy + transport.total_energy
        rates["absolute_vorticity_rate_gradient"] = gradient.absolute_vorticity
        rates["total_energy_rate_coriolis"] = coriolis.total_energy
        rates["absolute_vorticity_rate_coriolis"] = coriolis.absolute_vorticity
        advection = coriolis.potential_enstrophy + transport.potential_enstrophy
        rates["potential_enstrophy_rate_coriolis"] = advection + _enstrophy_from_coasts(model, bernoulli, q)
    for term in model.terms:
        own = model.tendency_of(term, state, time)
        any_source, any_force = (
            anywhere(model.processes, int(values.any())) for values in (own.thickness, own.normal_velocity)
        )
        by_source = _work_of_transport(model, own.thickness, bernoulli, q) if any_source else _NONE
        by_force = _work(model, flux, q, own.normal_velocity) if any_force else _NONE
        for integral in term.changes:
            source, force = getattr(by_source, integral), getattr(by_force, integral)
            rates[rate_name(integral, term.name)] = source + force
            if not term.after_steps and (integral == "mass" or not model.prescribed_wind):
                # The term's part in the tendency was taken for other causes above.
                if integral in _SOURCE_TAKEN_FOR:
                    rates[rate_name(integral, _SOURCE_TAKEN_FOR[integral])] -= source
                if integral in _FORCE_TAKEN_FOR_CORIOLIS:
                    rates[rate_name(integral, "coriolis")] -= force
    return rates


_SOURCE_TAKEN_FOR = {"mass": "transport", "total_energy": "exchange", "potential_enstrophy": "coriolis"}
"""The cause to which a tendency that is not split into terms attributes a source of thickness."""

_FORCE_TAKEN_FOR_CORIOLIS = ("total_energy", "potential_enstrophy", "absolute_vorticity")
"""Integrals for which such a tendency attributes an acceleration to the Coriolis force."""


def rates_of_time(
    row: Mapping[str, float], before: Mapping[str, float] | None, terms: Iterable[Term] = ()
) -> dict[str, float]:
    """Rates that the causes do not explain: those of the time step, from a row of diagnostics and the one before.

    They are the mean rates of change between the rows minus the summed causes, averaged over both rows. If the causes
    vanish, that is all of the change; otherwise it includes their variation between the rows. Zero in the first row.
    """
    rates = {}
    for integral, causes in causes_of_change(terms).items():
        rates[rate_name(integral, "time")] = 0.0
        if before is not None:
            change = (row[integral] - before[integral]) / (row["time"] - before["time"])
            explained = sum(row[rate_name(integral, cause)] + before[rate_name(integral, cause)] for cause in causes)
            rates[rate_name(integral, "time")] = change - 0.5 * explained
    return rates


@dataclass(frozen=True)
class _Work:
    """What a tendency does to the integrals, per second."""

    mass: float = 0.0
    total_energy: float = 0.0
    absolute_vorticity: float = 0.0
    potential_enstrophy: float = 0.0


_NONE = _Work()


def _work(model: ShallowWaterModel, flux: Array, potential_vorticity: Array, acceleration: Array) -> _Work:
    """What an `acceleration` at edges does to the integrals; `flux` is the mass flux there."""
    mesh, measures = model.closed, model.measures

    def work(coarse: Array, fine: Array, parts: Array) -> None:
        integral_kernels.work_of(
            acceleration,
            flux,
            potential_vorticity,
            mesh.edges_on_vertex,
            measures.circulation_signs,
            mesh.dc_edge,
            measures.dv_edge,
            coarse,
            fine,
            parts,
        )

    energy, vorticity, enstrophy = folded_sums(work, 3, model.entities, model.processes)
    return _Work(0.0, energy, vorticity, enstrophy)


def _work_of_transport(model: ShallowWaterModel, thickness_tendency: Array, bernoulli: Array, q: Array) -> _Work:
    """What a tendency of thickness at cells does to the integrals."""
    mesh, measures = model.closed, model.measures

    def work(coarse: Array, fine: Array, parts: Array) -> None:
        integral_kernels.work_of_transport(
            thickness_tendency,
            measures.area_cell,
            bernoulli,
            q,
            mesh.cells_on_vertex,
            measures.kite_areas_on_vertex,
            coarse,
            fine,
            parts,
        )

    mass, energy, enstrophy = folded_sums(work, 3, model.entities, model.processes)
    return _Work(mass, energy, 0.0, enstrophy)


def _work_of_forces(
    model: ShallowWaterModel, flux: Array, acceleration: Array, bernoulli: Array, q: Array
) -> tuple[_Work, _Work]:
    """What minus the gradient of the Bernoulli function, and then the rest of the acceleration, do to the integrals."""
    mesh, measures = model.closed, model.measures

    def work(coarse: Array, fine: Array, parts: Array) -> None:
        integral_kernels.work_of_forces(
            flux,
            acceleration,
            bernoulli,
            q,
            mesh.cells_on_edge,
            mesh.edges_on_vertex,
            measures.circulation_signs,
            mesh.dc_edge,
            measures.dv_edge,
            coarse,
            fine,
            parts,
        )

    energy, vorticity, *others = folded_sums(work, 5, model.entities, model.processes)
    return _Work(0.0, energy, vorticity, 0.0), _Work(0.0, *others)


def _enstrophy_from_coasts(model: ShallowWaterModel, bernoulli: Array, q: Array) -> float:
    """What minus the gradient of the Bernoulli function does to potential enstrophy, where its paths end at walls."""
    mesh, coast = model.closed, np.flatnonzero(boundary_vertices(model.mesh))
    if not anywhere(model.processes, len(coast)):
        return 0.0
    first, second = np.moveaxis(mesh.cells_on_edge[mesh.edges_on_vertex[coast]], -1, 0)
    circulation = model.measures.circulation_signs[coast] * (bernoulli[first] - bernoulli[second])
    at_vertices = np.zeros((1, mesh.n_vertices))
    at_vertices[0, coast] = q[coast] * circulation.sum(axis=1)
    return float(model.processes.exact_sums(at_vertices)[0])
