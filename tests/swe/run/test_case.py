"""The fields of a case, which may be the user's own, on a mesh."""

from collections.abc import Callable

import numpy as np
import pytest

from cases import LakeAtRest, Williamson5
from mesh import VoronoiMesh
from mesh.arrays import Array
from swe.errors import InputError
from swe.run.case import case_fields


def test_fields_are_those_of_the_case_on_the_sphere_of_its_radius(small_mesh: VoronoiMesh) -> None:
    fields = case_fields(Williamson5(), small_mesh, "point")
    assert fields.mesh.sphere_radius == 6371220.0
    assert fields.topography.max() == pytest.approx(1500.0, abs=500.0)
    np.testing.assert_allclose(fields.coriolis, 2.0 * 7.292e-5 * np.sin(small_mesh.lat_vertex), atol=1e-16)


@pytest.mark.parametrize("name", ["topography", "coriolis"])
@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda values: values[:3], r"has shape \(3,\), but the mesh needs"),
        (lambda values: np.where(np.arange(len(values)) == 7, np.nan, values), "is nan at entity 7"),
    ],
)
def test_fields_that_no_mesh_can_have_are_refused(
    small_mesh: VoronoiMesh, monkeypatch: pytest.MonkeyPatch, name: str, damage: Callable[[Array], Array], words: str
) -> None:
    right = getattr(LakeAtRest, f"{name}_on")
    monkeypatch.setattr(LakeAtRest, f"{name}_on", lambda *arguments: damage(right(*arguments)))
    with pytest.raises(InputError, match=f"{name} {words}"):
        case_fields(LakeAtRest(), small_mesh, "point")
