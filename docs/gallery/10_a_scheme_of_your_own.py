"""
A scheme of your own
====================

A scheme is a kinetic energy and the flux that goes with it. Any such pair keeps the total energy; a pair that does not
match does not.
"""

import matplotlib.pyplot as plt
import numpy as np

import trisk
from swe.diagnostics.invariants import measure_invariants
from swe.equations.schemes import Ringler2010, Scheme
from swe.stepping.time_stepping import RungeKutta

# %%
# The default scheme divides the energy of an edge evenly between its two cells. This one divides it in proportion to
# their areas:


class ByArea(Scheme):
    """Kinetic energy of the edges, divided in proportion to the areas of the cells."""

    name, source = "by area", "an example"

    def shares(self):
        """Parts of its energy that the first and the second cell of each edge receive, which add up to one."""
        areas = self.mesh.area_cell[self.mesh.cells_on_edge]
        return areas / areas.sum(axis=1, keepdims=True)

    def kinetic_energy(self, u, K):
        """Write what each cell receives, over its area."""
        energy = self.shares() * (0.5 * self.mesh.dv_edge * self.mesh.dc_edge * u**2)[:, None]
        cells = self.mesh.cells_on_edge.ravel()
        K[:] = np.bincount(cells, energy.ravel(), self.mesh.n_cells) / self.mesh.area_cell

    def flux(self, h, u, F):
        """Write the derivative of the energy, (dE/du) / (l d): thickness with the same shares."""
        F[:] = (self.shares() * h[self.mesh.cells_on_edge]).sum(axis=1) * u


class Mismatched(ByArea):
    """The same energy, with the flux of another scheme."""

    name = "mismatched"
    flux = Ringler2010.flux


# %%
# The model of a simulation, with another scheme in it, on an uneven mesh:

simulation = trisk.Simulation(trisk.scvt_mesh(642, density="refined-circle"), trisk.Williamson5())
given = simulation.model
STEPS, TIME_STEP = 40, 300.0


def energy_changes(scheme):
    """Relative changes of the energy, step by step."""
    model = trisk.ShallowWaterModel(given.mesh, given.topography, given.coriolis, given.gravity, scheme=scheme)
    state = simulation.state.copy()
    method = RungeKutta(model.tendency, state)
    energies = [measure_invariants(model, state, model.diagnose(state)).total_energy]
    for _ in range(STEPS):
        method.advance(state, TIME_STEP, 1)
        energies.append(measure_invariants(model, state, model.diagnose(state)).total_energy)
    return np.abs(np.array(energies[1:]) / energies[0] - 1.0)


figure, ax = plt.subplots(layout="constrained")
for scheme in (Ringler2010, ByArea, Mismatched):
    ax.semilogy(np.arange(1, STEPS + 1) * TIME_STEP / 3600.0, energy_changes(scheme), label=scheme.name)
ax.set_xlabel("time (hours)")
ax.set_ylabel("size of the relative change of total energy")
ax.legend()
