"""
A mesh and its quality
======================

A mesh of 2562 cells, how even its cells are, and where they are least so.
"""

# %%
# From a number of cells to a spherical centroidal Voronoi mesh, on the unit sphere:

import matplotlib.pyplot as plt
import numpy as np

import trisk

mesh = trisk.scvt_mesh(2562)
print(mesh)

# %%
# :class:`trisk.Quality` measures all of it. In an ideal mesh every distance between neighbours is the same,
# and ``sigma`` and ``q`` are one; the ``residual`` says how far generators are from the centroids of their cells.

for name, value in vars(trisk.mesh_quality(mesh)).items():
    print(f"{name:10} {value:.6g}")

# %%
# The same for each cell: sigma is the shortest over the longest distance to a neighbour. Twelve cells are pentagons,
# and the cells beside them are the least regular.

neighbours = np.arange(mesh.max_edges) < mesh.n_edges_on_cell[:, None]
distances = mesh.dc_edge[mesh.edges_on_cell]
sigma = np.where(neighbours, distances, np.inf).min(axis=1) / np.where(neighbours, distances, 0.0).max(axis=1)

figure, (globe, close) = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
trisk.plot_field(mesh, sigma, globe, centre=(0, 30), projection="orthographic", label="sigma of the cells")
trisk.plot_field(mesh, mesh.dc_edge * 6371.0, close, centre=(0, 30), extent=30, label="distance of the cells (km)")

# %%
# Many starting points lead to good meshes. Of random ones, some cells remain heptagons:

random = trisk.scvt_mesh(2562, start="random", seed=1)
for name, each in (("icosahedron", mesh), ("random", random)):
    quality = trisk.mesh_quality(each)
    print(f"{name:12} mean sigma {quality.sigma_avg:.3f}, smallest {quality.sigma_min:.3f}, mu {quality.mu:.2f}")

trisk.plot_field(random, random.n_edges_on_cell.astype(float), label="sides of the cells")
