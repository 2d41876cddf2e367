"""
Mesh against solution
=====================

A steady flow that is known exactly shows what the mesh does to the solution: all that changes is error.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt
import numpy as np

import trisk

folder = TemporaryDirectory()

# %%
# Test case 2 on three meshes of as many cells, with both schemes.

MESHES = {
    "icosahedron": trisk.scvt_mesh(2562),
    "random": trisk.scvt_mesh(2562, start="random", seed=1),
    "refined": trisk.scvt_mesh(2562, density="refined-circle"),
}
case = trisk.Williamson2()
runs = {}
for name, mesh in MESHES.items():
    for scheme in ("ringler2010", "consistent"):
        output = Path(folder.name) / f"{name}-{scheme}"
        trisk.Simulation(mesh, case, output, scheme=scheme).run(days=5)
        runs[name, scheme] = trisk.open_run(output)

comparison = trisk.compare_runs(*runs.values(), days=[5])
print("mesh         scheme        l2 error of thickness   smallest sigma")
for (name, scheme), entry in zip(runs, comparison.entries, strict=True):
    sigma = trisk.mesh_quality(MESHES[name]).sigma_min
    print(f"{name:12} {scheme:12} {entry.norms['thickness'].l2:22.2e} {sigma:16.3f}")

# %%
# Below, the error of the default scheme over the mesh that made it. On the first mesh it has the shape of the
# icosahedron; on the others it begins where cells are irregular or coarse, and waves and the flow carry it
# round the globe.

figure, axes = plt.subplots(3, 2, figsize=(12, 11), layout="constrained")
for row, (name, mesh) in zip(axes, MESHES.items(), strict=True):
    run = runs[name, "ringler2010"]
    width = np.sqrt(mesh.area_cell) * 6371.0
    trisk.plot_field(mesh, width, row[0], cmap="viridis", label="width of the cells (km)")
    row[0].set_title(name)
    exact = case.thickness(run.mesh.lon_cell, run.mesh.lat_cell)
    trisk.plot_field(run, run.snapshot(5).fields["thickness"] - exact, row[1], label="error of thickness (m)")
    row[1].set_title(f"{name}, day 5")
