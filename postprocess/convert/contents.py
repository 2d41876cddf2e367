"""What of a run is converted: its mesh, its fields by place, and its snapshots one by one."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mesh.arrays import Array
from mesh.safe_files import dataset
from postprocess.runs.reading import Progress, Run, Snapshot
from swe.diagnostics.outputs import FIELDS, TOPOGRAPHY, Field
from swe.output.files import HISTORY_FILE

TOPOGRAPHY_NAME = "topography"


@dataclass(frozen=True, eq=False)
class Contents:
    """A run, the times of its snapshots in seconds since the start, and its fields by name.

    `fields` are those that snapshots hold, `fixed` those that stay: their description and values (n,).
    """

    run: Run
    times: Array
    fields: dict[str, Field]
    fixed: dict[str, tuple[Field, Array]]

    def snapshots(self, progress: Progress) -> Iterator[tuple[int, Snapshot]]:
        """Number and fields of one snapshot after another; raise `InputError` where one is damaged."""
        days = self.run.days
        for number, day in enumerate(days):
            yield number, self.run.snapshot(float(day))
            progress("snapshots", (number + 1) / len(days))


def contents_of(run: Run) -> Contents:
    """The contents of a run whose files have been checked (`postprocess.runs.reading.checked`)."""
    with dataset(run.directory / HISTORY_FILE) as file:
        file.set_auto_mask(False)
        fields = {name: field for name, field in FIELDS.items() if name in file.variables}
        fixed = {}
        if TOPOGRAPHY_NAME in file.variables:
            fixed[TOPOGRAPHY_NAME] = (TOPOGRAPHY, np.asarray(file[TOPOGRAPHY_NAME][:]))
        times = np.asarray(file["time"][: len(run.days)])
    return Contents(run, times, fields, fixed)
