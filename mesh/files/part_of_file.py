"""INTERIM."""

import numpy as np

from mesh.files.io import mesh_hash, read_mesh, write_mesh
from mesh.parts.mesh_part import cut_part
from mesh.triangulation.ordering import hilbert_order


def read_part(path, blocks, block, rings):
    return cut_part(read_mesh(path), blocks, block, rings)


def blocks_along_curve(path, processes):
    mesh = read_mesh(path)
    order = hilbert_order(mesh.cell_points / mesh.sphere_radius)
    result = np.empty(mesh.n_cells, np.int32)
    result[order] = np.arange(mesh.n_cells) * processes // mesh.n_cells
    return result


def hash_of_file(path, radius):
    return mesh_hash(read_mesh(path).scaled(radius)), True


def write_scaled_copy(path, target, radius, history):
    write_mesh(read_mesh(path).scaled(radius), target, history)
