"""Spherical centroidal Voronoi meshes: generation, topology, metrics, TRiSK operators, files and quality."""

from mesh.build import mesh_from_points, scvt_mesh
from mesh.errors import MeshError, MeshWarning
from mesh.io import read_mesh, write_mesh
from mesh.operators import Operators, build_operators
from mesh.quality import Quality, mesh_quality
from mesh.validate import validate_mesh
from mesh.voronoi_mesh import VoronoiMesh

__all__ = [
    "MeshError",
    "MeshWarning",
    "Operators",
    "Quality",
    "VoronoiMesh",
    "build_operators",
    "mesh_from_points",
    "mesh_quality",
    "read_mesh",
    "scvt_mesh",
    "validate_mesh",
    "write_mesh",
]
