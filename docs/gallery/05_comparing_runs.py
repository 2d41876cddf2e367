"""
Comparing two runs
==================

Two runs of one case on different meshes: norms of their difference, and where it is.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import trisk

folder = TemporaryDirectory()
for cells in (642, 2562):
    simulation = trisk.Simulation(trisk.scvt_mesh(cells), trisk.Williamson5(), Path(folder.name) / f"{cells}")
    simulation.run(days=15)

coarse, fine = (trisk.open_run(Path(folder.name) / cells) for cells in ("642", "2562"))

# %%
# One run may be the reference of the other; its fields are then taken to the other's cells.

print(trisk.compare_runs(coarse, reference=fine, days=[5, 10, 15]))

# %%
# For this case the package holds a solution by a spectral model, which both can be measured against:

comparison = trisk.compare_runs(coarse, fine, days=[5, 10, 15])
print(comparison)

# %%
# Norms are numbers to work with too.

figure, ax = plt.subplots(layout="constrained")
for run in (coarse, fine):
    entries = [entry for entry in comparison.entries if entry.run is run]
    ax.semilogy(
        [entry.day for entry in entries], [entry.norms["thickness"].l2 for entry in entries], "o-", label=run.cells
    )
ax.set_xlabel("time (days)")
ax.set_ylabel("l2 error of thickness")
ax.legend(title="cells")

# %%
# Where two runs share a mesh, their difference is that of their values. What does another scheme change?

other = trisk.Simulation(fine.mesh, trisk.Williamson5(), Path(folder.name) / "consistent", scheme="consistent")
other.run(days=15)
changed = trisk.open_run(Path(folder.name) / "consistent")
difference = changed.snapshot(15).fields["thickness"] - fine.snapshot(15).fields["thickness"]
trisk.plot_field(fine, difference, label="thickness, consistent - ringler2010 (m)")
