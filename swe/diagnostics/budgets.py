"""Budgets: how fast each term of the discrete equations changes each of the global integrals.

With F_e = h_e u_e and the Bernoulli function B_i = g (h_i + b_i) + K_i, an acceleration a_e of the fluid changes total
energy by the sum of l_e d_e F_e a_e, absolute vorticity by that of the circulations C_v = sum_e t_ev d_e a_e and
potential enstrophy by that of q_v C_v; a tendency of thickness changes them by A_i B_i dh_i and -q_v^2/2 kite_vi dh_i.
Thuburn et al. (2009) and Ringler et al. (2010) show which of the terms cancel: the work of the Coriolis force, and that
of minus the gradient of B against the transport of B by the mass flux. They do so to round-off.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from swe.equations import kernels
from swe.equations.dissipation import BiharmonicDissipation
from swe.equations.model import Diagnosis, ShallowWaterModel
from swe.state import State

RATES = {
    "mass": ("m3 s-1", ("transport",)),
    "total_energy": ("m5 s-3", ("coriolis", "exchange", "dissipation")),
    "potential_enstrophy": ("m s-3", ("coriolis", "anticipation", "dissipation")),
    "absolute_vorticity": ("m2 s-2", ("coriolis", "gradient", "dissipation")),
}
"""For each integral the units of its rates and the terms that change it, besides the time step."""

MEANINGS = {
    "transport": "by the divergence of the mass flux, zero but for round-off",
    "exchange": "by the gradient of the Bernoulli function and the mass flux, zero but for round-off",
    "gradient": "by the gradient of the Bernoulli function, zero but for round-off",
    "anticipation": "by the anticipation of potential vorticity",
    "dissipation": "by biharmonic dissipation",
    "time": "since the row before, on the average, less the terms' mean of both rows: by the time step",
}
"""What a term is, apart from the Coriolis force, whose effect on potential enstrophy does not vanish."""

CORIOLIS = {
    "total_energy": "by the work of the Coriolis force, zero but for round-off",
    "absolute_vorticity": "by the curl of the Coriolis force, zero but for round-off",
    "potential_enstrophy": "by the Coriolis force and the mass flux, that is by the advection of potential vorticity",
}


def rate_name(integral: str, term: str) -> str:
    """Name of a rate in the diagnostics file."""
    return f"{integral}_rate_{term}"


def rate_series() -> dict[str, tuple[str, str]]:
    """Units and meaning of every rate by its name."""
    return {
        rate_name(integral, term): (
            units,
            f"rate of {integral.replace('_', ' ')} " + (CORIOLIS[integral] if term == "coriolis" else MEANINGS[term]),
        )
        for integral, (units, terms) in RATES.items()
        for term in (*terms, "time")
    }


@dataclass(frozen=True)
class _Work:
    """What an acceleration does to the integrals, per second."""

    total_energy: float
    absolute_vorticity: float
    potential_enstrophy: float


def measure_rates(
    model: ShallowWaterModel,
    state: State,
    diagnosis: Diagnosis,
    tendency: State,
    dissipation: BiharmonicDissipation | None = None,
) -> dict[str, float]:
    """Rates of the integrals at `state` by the terms of `RATES`, under the names of the diagnostics file.

    `diagnosis` belongs to `state`, and `tendency` is what the run takes its steps with, without `dissipation`. Under a
    prescribed wind no force acts, and all but the transport of mass is zero.
    """
    rates = dict.fromkeys((name for name in rate_series() if not name.endswith("_time")), 0.0)
    mesh, h, u, q = model.mesh, state.thickness, state.normal_velocity, diagnosis.potential_vorticity
    bernoulli, of_transport = np.empty(mesh.n_cells), np.empty((kernels.BLOCKS, 3))
    kernels.bernoulli(h, model.topography, diagnosis.kinetic_energy, model.gravity, bernoulli)
    kernels.work_of_transport(
        tendency.thickness,
        mesh.area_cell,
        bernoulli,
        q,
        mesh.cells_on_vertex,
        mesh.kite_areas_on_vertex,
        of_transport,
    )
    mass, energy, enstrophy = of_transport.sum(axis=0).tolist()
    rates["mass_rate_transport"] = mass
    if model.prescribed_wind:
        return rates
    of_forces = np.empty((kernels.BLOCKS, 5))
    kernels.work_of_forces(
        h,
        u,
        tendency.normal_velocity,
        bernoulli,
        q,
        mesh.cells_on_edge,
        mesh.edges_on_vertex,
        model.sign_on_vertex,
        mesh.dc_edge,
        mesh.dv_edge,
        of_forces,
    )
    pressure_energy, pressure_vorticity, *coriolis = of_forces.sum(axis=0).tolist()
    rates["total_energy_rate_exchange"] = pressure_energy + energy
    rates["absolute_vorticity_rate_gradient"] = pressure_vorticity
    rates["total_energy_rate_coriolis"], rates["absolute_vorticity_rate_coriolis"] = coriolis[:2]
    rates["potential_enstrophy_rate_coriolis"] = coriolis[2] + enstrophy
    if model.anticipation > 0.0:
        anticipation = _work(model, state, q, model.anticipated_acceleration(state)).potential_enstrophy
        rates["potential_enstrophy_rate_anticipation"] = anticipation
        rates["potential_enstrophy_rate_coriolis"] -= anticipation
    if dissipation is not None:
        for integral, rate in vars(_work(model, state, q, dissipation.acceleration(u))).items():
            rates[rate_name(integral, "dissipation")] = rate
    return rates


def rates_of_time(row: Mapping[str, float], before: Mapping[str, float] | None) -> dict[str, float]:
    """Rates that the terms do not explain: those of the time step, from a row of diagnostics and the one before.

    They are the mean rates of change in between less the mean of the terms' sums of both rows: all of the former where
    the terms vanish, else with what the terms varied in between. Zero in the first row.
    """
    rates = {}
    for integral, (_, terms) in RATES.items():
        rates[rate_name(integral, "time")] = 0.0
        if before is not None:
            change = (row[integral] - before[integral]) / (row["time"] - before["time"])
            explained = sum(row[rate_name(integral, term)] + before[rate_name(integral, term)] for term in terms)
            rates[rate_name(integral, "time")] = change - 0.5 * explained
    return rates


def _work(model: ShallowWaterModel, state: State, potential_vorticity: Array, acceleration: Array) -> _Work:
    mesh, flux, sums = model.mesh, np.empty(model.mesh.n_edges), np.empty((kernels.BLOCKS, 3))
    kernels.thickness_flux(state.thickness, state.normal_velocity, mesh.cells_on_edge, flux)
    kernels.work_of(
        acceleration,
        flux,
        potential_vorticity,
        mesh.edges_on_vertex,
        model.sign_on_vertex,
        mesh.dc_edge,
        mesh.dv_edge,
        sums,
    )
    energy, vorticity, enstrophy = sums.sum(axis=0).tolist()
    return _Work(energy, vorticity, enstrophy)
