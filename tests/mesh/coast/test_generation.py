"""From a region to its mesh."""

import numpy as np
import pytest

from mesh import MeshError, mesh_quality
from mesh.coast.generation import COAST_SPACINGS, coast_smoothing, region_mesh, spacing_before_coastline
from mesh.discrete.quality import bent_cells
from mesh.discrete.walls import wall_edges
from mesh.mesh_request import MeshRequest
from mesh.regions.find import find_region

BOX = "300,340,20,50"


@pytest.mark.parametrize("method", ["lbfgs", "lloyd"])
def test_a_box_is_filled_up_to_its_sides(method: str) -> None:
    region = find_region(BOX)
    residuals = []
    request = MeshRequest(cells=150, method=method, tolerance=None if method == "lbfgs" else 1e-3)
    mesh = region_mesh(region, request, lambda iterate: residuals.append(iterate.residual))
    assert residuals[-1] <= (1e-6 if method == "lbfgs" else 1e-3)
    assert mesh.n_cells == 150
    assert (mesh.density_name, mesh.fixed_cells) == ("uniform", None)
    box = np.radians(40.0) * (np.sin(np.radians(50.0)) - np.sin(np.radians(20.0)))
    assert mesh.area_cell.sum() == pytest.approx(box, rel=0.02)
    spacing = spacing_before_coastline(region, 150)
    assert np.abs(region.distance(mesh.vertex_points[mesh.boundary_vertex == 1])).max() < 0.5 * COAST_SPACINGS * spacing
    assert np.abs(mesh.area_cell / mesh.area_cell.mean() - 1.0).max() < 0.4
    assert len(wall_edges(mesh)) > 30
    # Of the cells whose coast is straight; the box has corners, which are smoothed, and parallels.
    assert 4 <= np.count_nonzero(bent_cells(mesh)) < len(wall_edges(mesh)) + 1
    assert mesh_quality(mesh).residual == pytest.approx(mesh_quality(mesh.scaled(6371220.0)).residual, rel=1e-6)
    assert mesh_quality(mesh).residual <= residuals[-1] + 1e-9


def test_a_density_refines_part_of_the_sea() -> None:
    def density(points: np.ndarray) -> np.ndarray:
        return 8.5 + 7.5 * np.tanh(20.0 * (points[:, 2] - 0.6))

    mesh = region_mesh(find_region(BOX), MeshRequest(cells=300, density=density, tolerance=1e-4))
    dense = mesh.z_cell > 0.68
    rest = mesh.z_cell < 0.52
    assert 3.0 < np.median(mesh.area_cell[rest]) / np.median(mesh.area_cell[dense]) < 5.0


def test_meshes_of_one_smoothing_fill_the_same_sea() -> None:
    region = find_region(BOX)
    coarse, fine = MeshRequest(60, tolerance=1e-3), MeshRequest(150, tolerance=1e-3)
    wide = coast_smoothing(region, 20)
    areas = [region_mesh(region, request, smoothing=wide).area_cell.sum() for request in (coarse, fine)]
    assert areas[1] == pytest.approx(areas[0], rel=1e-12)
    # Corners of the box are cut off less for more cells.
    assert region_mesh(region, fine).area_cell.sum() > 1.03 * areas[1]


@pytest.mark.parametrize(
    ("request_", "message"),
    [
        (MeshRequest(cells=150, method="macqueen"), "cannot use the method macqueen; choose lbfgs or lloyd"),
        (MeshRequest(cells=150, well_centered=True), "neither nested nor made well-centred"),
        (MeshRequest(), "the number of cells is missing"),
        (MeshRequest(cells=150, start="icosahedral"), "cannot start from 'icosahedral'"),
        (MeshRequest(cells=150, max_iterations=3), "after 3 iterations and does not reach the tolerance"),
    ],
)
def test_what_cannot_be_made_is_refused(request_: MeshRequest, message: str) -> None:
    with pytest.raises(MeshError, match=message):
        region_mesh(find_region(BOX), request_)
