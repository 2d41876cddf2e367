"""Global integrals that the continuous equations conserve, and their changes during a run."""

import sys
from dataclasses import dataclass

import numpy as np

from swe.diagnostics import integral_kernels
from swe.equations.model import Diagnosis, ShallowWaterModel
from swe.state import State


@dataclass(frozen=True)
class Invariants:
    """Mass (m3), energies (m5/s2), potential enstrophy (m/s2) and absolute vorticity (m2/s), per unit density.

    `available_potential_energy` is measured from the state of rest with the same mass and a level surface.
    `potential_energy_of_depth` is measured from the bottom everywhere, so it is positive whatever the topography.
    `planetary_vorticity_magnitude` is the integral of |f|, the yardstick for changes of absolute vorticity.
    """

    mass: float
    kinetic_energy: float
    potential_energy: float
    available_potential_energy: float
    potential_energy_of_depth: float
    potential_enstrophy: float
    absolute_vorticity: float
    planetary_vorticity_magnitude: float

    @property
    def total_energy(self) -> float:
        """Kinetic and potential energy, m5/s2."""
        return self.kinetic_energy + self.potential_energy

    @property
    def available_energy(self) -> float:
        """Kinetic and available potential energy, m5/s2."""
        return self.kinetic_energy + self.available_potential_energy

    @property
    def energy_of_depth(self) -> float:
        """Kinetic energy and potential energy of the depth, m5/s2; positive, and as large as the terms summed."""
        return self.kinetic_energy + self.potential_energy_of_depth


def measure_invariants(model: ShallowWaterModel, state: State, diagnosis: Diagnosis) -> Invariants:
    """The invariants of `state` and of what follows from it, on the mesh of `model`.

    Kinetic energy is the sum of A_i h_i K_i, potential energy that of g A_i h_i (h_i/2 + b_i), potential enstrophy
    that of A_v h_v q_v^2/2, absolute vorticity that of A_v (f_v + zeta_v): Ringler et al. (2010), section 3.
    """
    mesh, measures, h, g = model.mesh, model.measures, state.thickness, model.gravity
    (mass,) = model.processes.exact_sums((measures.area_cell * h)[None])
    level = _level(model, mass)
    on_cells, on_vertices = np.empty((4, mesh.n_cells)), np.empty((2, mesh.n_vertices))
    integral_kernels.energies(measures.area_cell, h, model.topography, diagnosis.kinetic_energy, level, on_cells)
    integral_kernels.vorticities(
        measures.area_triangle, model.coriolis, diagnosis.relative_vorticity, diagnosis.potential_vorticity, on_vertices
    )
    kinetic, potential, available, of_depth = model.processes.exact_sums(on_cells)
    absolute_vorticity, enstrophy = model.processes.exact_sums(on_vertices)
    return Invariants(
        mass=mass,
        kinetic_energy=kinetic,
        potential_energy=g * potential,
        available_potential_energy=0.5 * g * available,
        potential_energy_of_depth=0.5 * g * of_depth,
        potential_enstrophy=0.5 * enstrophy,
        absolute_vorticity=absolute_vorticity,
        planetary_vorticity_magnitude=model.planetary_vorticity_magnitude,
    )


def mean_level(model: ShallowWaterModel, state: State) -> float:
    """Height of the level surface over the same mass, m."""
    (mass,) = model.processes.exact_sums((model.measures.area_cell * state.thickness)[None])
    return _level(model, mass)


def _level(model: ShallowWaterModel, mass: float) -> float:
    return (mass + model.bottom_volume) / model.area


@dataclass(frozen=True)
class Changes:
    """Changes since the start, each relative to a yardstick.

    The change of mass is relative to the initial mass, that of total energy to the initial available energy and, as a
    second number, to the initial total energy, that of potential enstrophy to its initial value, and that of absolute
    vorticity to the integral of |f|.
    """

    mass: float
    total_energy: float
    total_energy_of_total: float
    potential_enstrophy: float
    absolute_vorticity: float


def relative_changes(initial: Invariants, present: Invariants) -> Changes:
    """Changes from `initial` to `present`.

    A yardstick of zero (no rotation) is replaced by one. An available energy (of a level surface at rest) or total
    energy (cancelled by topography below zero) that is lost in round-off is replaced by `Invariants.energy_of_depth`.
    """
    energy = (present.kinetic_energy - initial.kinetic_energy) + (present.potential_energy - initial.potential_energy)
    return Changes(
        mass=(present.mass - initial.mass) / initial.mass,
        total_energy=energy / _energy_yardstick(initial.available_energy, initial),
        total_energy_of_total=energy / _energy_yardstick(initial.total_energy, initial),
        potential_enstrophy=(present.potential_enstrophy - initial.potential_enstrophy)
        / (initial.potential_enstrophy or 1.0),
        absolute_vorticity=(present.absolute_vorticity - initial.absolute_vorticity)
        / (initial.planetary_vorticity_magnitude or 1.0),
    )


def _energy_yardstick(energy: float, initial: Invariants) -> float:
    """The magnitude of `energy`, or the energy of the initial depth if `energy` is lost in its round-off."""
    lost = abs(energy) <= sys.float_info.epsilon * initial.energy_of_depth
    return (initial.energy_of_depth or 1.0) if lost else abs(energy)
