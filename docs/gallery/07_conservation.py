"""
What is conserved
=================

Mass, absolute vorticity and total energy along a run, and how methods differ in what they keep.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import trisk

folder = TemporaryDirectory()
mesh, case = trisk.scvt_mesh(2562), trisk.Williamson5()

# %%
# The equations in space keep mass, absolute vorticity and total energy; only the steps in time lose energy. ``rk4``,
# the default, loses little, ``rrk4`` none beyond round-off. Anticipation damps potential enstrophy, at no cost in
# energy.

OPTIONS = {
    "rk4": {},
    "rrk4": {"integrator": "rrk4"},
    "rk4, anticipation": {"anticipation": 0.5},
}
runs = {}
for number, (name, options) in enumerate(OPTIONS.items()):
    output = Path(folder.name) / str(number)
    trisk.Simulation(mesh, case, output, **options).run(days=20)
    runs[name] = trisk.open_run(output)

# %%
# Each run has the changes of its integrals since the start in its ``series``:

INTEGRALS = {
    "mass_change": "mass",
    "absolute_vorticity_change": "absolute vorticity",
    "total_energy_change": "total energy / available energy",
    "potential_enstrophy_change": "potential enstrophy",
}
figure, axes = plt.subplots(2, 2, figsize=(11, 7), layout="constrained", sharex=True)
for ax, (name, label) in zip(axes.flat, INTEGRALS.items(), strict=True):
    for method, run in runs.items():
        change = np.maximum(np.abs(run.series[name][1:]), 1e-17)
        ax.semilogy(run.series["time"][1:] / 86400.0, change, label=method)
    ax.set_title(label)
axes[0, 0].legend()
figure.supxlabel("time (days)")
figure.supylabel("size of the relative change since the start")

# %%
# The budgets say why an integral changes. Neither the Coriolis force nor the exchange of kinetic and potential energy
# changes the total, whatever the flow:

series = runs["rk4"].series
for name in sorted(series):
    if name.startswith("total_energy_rate_"):
        print(f"{name:36} {np.abs(series[name]).max():9.2e} m5 s-3")
print(f"total energy                         {series['total_energy'][0]:9.2e} m5 s-2")
