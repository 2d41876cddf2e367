"""
A refined region
================

Cells are small where a density is high: their width goes as the density to the power of -1/4.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import trisk

# %%
# ``refined-circle`` is a density that comes with the package; any function of unit vectors (m, 3) will do as well.

circle = trisk.scvt_mesh(2562, density="refined-circle")


def belt(points):
    """Cells of half the width along the equator."""
    return 1.0 + 15.0 * np.exp(-((points[:, 2] / 0.3) ** 2))


band = trisk.scvt_mesh(2562, density=belt)

figure, axes = plt.subplots(1, 2, figsize=(12, 4), layout="constrained")
for ax, mesh in zip(axes, (circle, band), strict=True):
    width = np.sqrt(mesh.area_cell) * 6371.0
    trisk.plot_field(mesh, width, ax, cmap="viridis", label="width of the cells (km)")
    ax.set_title(f"from {width.min():.0f} to {width.max():.0f} km")

# %%
# A mesh can also be refined where it stands: the generators elsewhere do not move.

coarse = trisk.scvt_mesh(642)
nested = trisk.scvt_mesh(nested=coarse, density="refined-box")
print(f"{coarse.n_cells} cells became {nested.n_cells}")
trisk.plot_field(nested, np.sqrt(nested.area_cell) * 6371.0, cmap="viridis", label="width of the cells (km)")

# %%
# Runs take such meshes as any other. The circle lies round the mountain of test case 5, whose wake it resolves:

folder = TemporaryDirectory()
figure, axes = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
for ax, (name, mesh) in zip(axes, {"uniform": trisk.scvt_mesh(2562), "refined": circle}.items(), strict=True):
    output = Path(folder.name) / name
    trisk.Simulation(mesh, trisk.Williamson5(), output).run(days=3)
    trisk.plot_field(output, "relative_vorticity", ax, centre=(-80, 35), extent=60)
    ax.set_title(f"{name}, day 3")
