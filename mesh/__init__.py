"""Spherical and planar centroidal Voronoi meshes: generation, topology, metrics, TRiSK operators, files and quality."""

import os

# Where other programs use the processors too, threads that spin at barriers make small meshes up to 15 times slower;
# threads that sleep cost little where they do not. Must be set before the first parallel kernel loads OpenMP.
os.environ.setdefault("OMP_WAIT_POLICY", "passive")

import mesh.compiled_cache
import mesh.forks  # noqa: F401
from mesh.coast.generation import region_mesh
from mesh.discrete.build import mesh_from_points
from mesh.discrete.operators import Operators, build_operators, normal_component
from mesh.discrete.quality import Quality, mesh_quality
from mesh.discrete.validate import validate_mesh
from mesh.errors import MeshError, MeshWarning
from mesh.files.io import read_mesh, write_mesh
from mesh.generation.pipeline import scvt_mesh
from mesh.mesh_request import MeshRequest
from mesh.partition.partition import Partition, partition_mesh
from mesh.parts.sea_cells import cull_mesh
from mesh.plane.generation import mesh_on_plane
from mesh.plane.hexagons import hexagon_mesh
from mesh.plane.periodic import periodic_mesh
from mesh.polygon.generation import polygon_mesh
from mesh.regions.find import find_region
from mesh.regions.region import Region
from mesh.voronoi_mesh import VoronoiMesh

__all__ = [
    "MeshError",
    "MeshRequest",
    "MeshWarning",
    "Operators",
    "Partition",
    "Quality",
    "Region",
    "VoronoiMesh",
    "build_operators",
    "cull_mesh",
    "find_region",
    "hexagon_mesh",
    "mesh_from_points",
    "mesh_on_plane",
    "mesh_quality",
    "normal_component",
    "partition_mesh",
    "periodic_mesh",
    "polygon_mesh",
    "read_mesh",
    "region_mesh",
    "scvt_mesh",
    "validate_mesh",
    "write_mesh",
]
