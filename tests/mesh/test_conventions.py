from dataclasses import fields

import numpy as np
import pytest

from mesh import VoronoiMesh
from mesh.conventions import BY_NAME, MESH_VARIABLES
from mesh.voronoi_mesh import METRICS_NAMES, TOPOLOGY_NAMES


def test_table_and_dataclass_name_the_same_arrays() -> None:
    arrays = {field.name for field in fields(VoronoiMesh)} - {
        "sphere_radius",
        "x_period",
        "y_period",
        "density_name",
        "density_source",
        "fixed_cells",
    }
    assert set(BY_NAME) == arrays == {*TOPOLOGY_NAMES, *METRICS_NAMES, "mesh_density"}


@pytest.mark.parametrize(
    ("name", "file_name"),
    [("cells_on_edge", "cellsOnEdge"), ("kite_areas_on_vertex", "kiteAreasOnVertex"), ("x_cell", "xCell")],
)
def test_file_names_are_camel_case(name: str, file_name: str) -> None:
    assert BY_NAME[name].file_name == file_name


def test_arrays_have_the_dtype_of_the_table(icosahedral_mesh: VoronoiMesh) -> None:
    for variable in MESH_VARIABLES:
        array = getattr(icosahedral_mesh, variable.name)
        assert array.dtype == (np.int32 if variable.integer else np.float64), variable.name
        assert array.flags.c_contiguous, variable.name
