"""Each identity of the discrete calculus notices an operator in which one entry is wrong."""

from mesh import VoronoiMesh, build_operators
from mesh.discrete.identities import _adjoint_defect, _curl_of_gradient, _perp_inconsistency


def test_two_weights_in_the_wrong_place_are_noticed(icosahedral_mesh: VoronoiMesh) -> None:
    """Their sum stays as it is, so that only a flux that varies tells them apart."""
    mesh, operators = icosahedral_mesh, build_operators(icosahedral_mesh)
    assert _perp_inconsistency(mesh, operators) < 1e-12
    start = operators.perp.indptr[17]
    operators.perp.data[[start, start + 1]] = operators.perp.data[[start + 1, start]]
    assert _perp_inconsistency(mesh, operators) > 1e-3


def test_a_wrong_side_of_a_triangle_is_noticed(icosahedral_mesh: VoronoiMesh) -> None:
    mesh, operators = icosahedral_mesh, build_operators(icosahedral_mesh)
    assert _curl_of_gradient(mesh, operators) < 1e-12
    operators.curl.data[5] *= 1.1
    assert _curl_of_gradient(mesh, operators) > 1e-3


def test_a_wrong_side_of_a_cell_is_noticed(icosahedral_mesh: VoronoiMesh) -> None:
    mesh, operators = icosahedral_mesh, build_operators(icosahedral_mesh)
    assert _adjoint_defect(mesh, operators) < 1e-12
    operators.divergence.data[5] *= 1.1
    assert _adjoint_defect(mesh, operators) > 1e-6


def test_a_wrong_gradient_is_noticed(icosahedral_mesh: VoronoiMesh) -> None:
    """Only a thickness that varies has one."""
    mesh, operators = icosahedral_mesh, build_operators(icosahedral_mesh)
    operators.gradient.data[:] *= 1.1
    assert _adjoint_defect(mesh, operators) > 1e-3
