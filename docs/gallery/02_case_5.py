"""
Flow over a mountain
====================

Test case 5 of Williamson et al. (1992): a zonal flow meets an isolated mountain, and sheds waves over the globe.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib.pyplot as plt

import trisk

folder = TemporaryDirectory()

# %%
# A mesh, a case and a directory for the results make a simulation.

simulation = trisk.Simulation(trisk.scvt_mesh(2562), trisk.Williamson5(), Path(folder.name) / "run")
simulation.run(days=15)
print(simulation.invariants)

# %%
# The directory can be opened now, or on another day.

run = trisk.open_run(Path(folder.name) / "run")
print(run)

# %%
# Maps show the real cells: thickness has its values at cells, vorticity at the triangles between them.

figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4), layout="constrained")
trisk.plot_field(run, "thickness", left)
left.set_title("day 15")
trisk.plot_field(run, "relative_vorticity", right)
right.set_title("day 15")

# %%
# The mountain stands at 90° W, 30° N. This is the flow behind it:

figure, axes = plt.subplots(1, 3, figsize=(14, 4.6), layout="constrained")
for ax, day in zip(axes, (1, 3, 5), strict=True):
    trisk.plot_field(run, "relative_vorticity", ax, time=day, centre=(-75, 35), extent=90)
    ax.set_title(f"day {day}")
