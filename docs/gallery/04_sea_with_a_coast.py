"""
A sea with a coast
==================

A mesh may cover a sea alone. Its coast follows the sides of whole cells, or clips them.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import trisk

# %%
# A region is a box in degrees (west, east, south, north), a file of polygons, or a sea of the real Earth, whose coasts
# need the extra ``coast``. Culling keeps the cells whose centres lie in it:

globe = trisk.scvt_mesh(10242)
culled = trisk.cull_mesh(globe, "north-atlantic")

# %%
# A mesh generated for the region has cells that end at the coast:

clipped = trisk.region_mesh(trisk.find_region("north-atlantic"), trisk.MeshRequest(cells=1000))

figure, axes = plt.subplots(1, 2, figsize=(12, 5.5), layout="constrained")
for ax, mesh, how in zip(axes, (culled, clipped), ("culled", "clipped"), strict=True):
    trisk.plot_field(
        mesh, mesh.area_cell * 6371.0**2 / 1000.0, ax, centre=(-50, 35), extent=(90, 80), label="area (1000 km²)"
    )
    ax.set_title(f"{how}: {mesh.n_cells} cells")

# %%
# Nothing flows through a coast, so mass and energy are conserved as on the sphere. A wind that drives two gyres, from
# rest:

folder = TemporaryDirectory()
gyres = trisk.DoubleGyre(viscosity=2e4)
simulation = trisk.Simulation(clipped, gyres, Path(folder.name) / "gyres", snapshot_interval=10 * 86400.0)
simulation.run(days=60)
run = trisk.open_run(Path(folder.name) / "gyres")

figure, axes = plt.subplots(1, 2, figsize=(12, 5.5), layout="constrained")
for ax, field in zip(axes, ("thickness", "kinetic_energy"), strict=True):
    trisk.plot_field(run, field, ax, centre=(-50, 35), extent=(90, 80))
    ax.set_title(f"day {run.days[-1]:g}")
