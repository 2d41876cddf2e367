"""Paths are paths, whether text or `Path`, in all that users call; numbers of numpy are numbers."""

from pathlib import Path

import numpy as np
import pytest

from cases import Williamson2
from mesh import MeshError, read_mesh, scvt_mesh, write_mesh
from postprocess.compare.comparison import compare_runs
from postprocess.figures.spectra_figure import write_spectra_of
from postprocess.reference.reference_file import read_reference, write_reference
from postprocess.reference.stored_references import stored_path
from postprocess.runs.reading import read_run
from swe import Simulation


def test_text_serves_as_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("ducc0")
    monkeypatch.chdir(tmp_path)
    write_mesh(scvt_mesh(42), "mesh.nc")
    for name in ("one", "other"):
        Simulation(read_mesh("mesh.nc"), Williamson2(), name, time_step=1800 if name == "one" else 3600).run(
            0.25, progress=False
        )
    assert read_run("one").directory == Path("one")
    assert compare_runs("one", "other", reference="one").entries[1].norms["thickness"].l2 > 0.0
    assert compare_runs("other", reference=Path("one")).entries[0].norms["thickness"].l2 > 0.0
    written = write_spectra_of([read_run("one")], (), "spectra")
    assert all(path.is_file() for path in written)
    stored = stored_path("williamson5")
    assert stored is not None
    reference = read_reference(str(stored))
    write_reference(reference, "reference.nc")
    assert read_reference("reference.nc").days == reference.days


def test_numbers_of_numpy_make_the_same_mesh() -> None:
    mesh = scvt_mesh(np.int64(42), tolerance=np.float32(1e-3), seed=np.int16(3), max_iterations=np.array(50))
    np.testing.assert_array_equal(mesh.x_cell, scvt_mesh(42, tolerance=1e-3, seed=3).x_cell)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"cells": "42"}, "the number of cells is '42'; it must be a number"),
        ({"cells": 42.5}, "the number of cells is 42.5; it must be a whole number"),
        ({"cells": 42, "tolerance": "small"}, "the tolerance is 'small'; it must be a number"),
        ({"cells": 42, "seed": None}, "the seed is None; it must be a number"),
    ],
)
def test_what_is_no_number_is_refused(options: dict[str, object], words: str) -> None:
    with pytest.raises(MeshError, match=f"^{words}$"):
        scvt_mesh(**options)  # type: ignore[arg-type]
