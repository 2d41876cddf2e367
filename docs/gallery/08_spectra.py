"""
Spectra
=======

Kinetic energy and potential enstrophy against wavenumber, from spherical harmonics. They need the extra ``reference``.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import trisk
from postprocess.compare.spectra import spectra_of

folder = TemporaryDirectory()

# %%
# The jet of ``galewsky`` breaks into eddies within six days, with dissipation and without it.

DISSIPATION = {"none": 0.0, "1e16 m4/s": 1e16}
runs = {}
mesh = trisk.scvt_mesh(2562)
for name, coefficient in DISSIPATION.items():
    output = Path(folder.name) / name.split()[0]
    trisk.Simulation(mesh, trisk.Galewsky(), output, dissipation=coefficient).run(days=10)
    runs[name] = trisk.open_run(output)

figure, axes = plt.subplots(1, 2, figsize=(12, 4), layout="constrained")
for ax, (name, run) in zip(axes, runs.items(), strict=True):
    trisk.plot_field(run, "relative_vorticity", ax, centre=(0, 90), extent=150)
    ax.set_title(f"dissipation: {name}, day 10")

# %%
# Enstrophy moves to the smallest scales that the mesh has, and stays there unless something takes it away.

figure, axes = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
for name, run in runs.items():
    for day, style in ((0, ":"), (10, "-")):
        spectra = spectra_of(run, day)
        colour = "tab:blue" if name == "none" else "tab:orange"
        for ax, values in zip(axes, (spectra.kinetic_energy, spectra.potential_enstrophy), strict=True):
            ax.loglog(range(1, len(values)), values[1:], style, color=colour, label=f"{name}, day {day}")
axes[0].set_ylabel("kinetic energy (m² s⁻²)")
axes[1].set_ylabel("potential enstrophy (m⁻¹ s⁻²)")
for ax in axes:
    ax.set_xlabel("total wavenumber")
    ax.grid(alpha=0.3)
axes[0].legend(title="dissipation")
