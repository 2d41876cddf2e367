from pathlib import Path

import numpy as np
import pytest

from mesh import MeshError
from mesh.generation.checkpoint import CheckpointKeeper
from mesh.generation.optimizer import Iterate
from mesh.geometry.sphere import fibonacci_points
from mesh.mesh_request import MeshRequest

REQUEST = MeshRequest(50)


def test_the_best_points_are_kept(tmp_path: Path) -> None:
    keeper = CheckpointKeeper(tmp_path / "c.npz", REQUEST)
    assert not keeper.save()
    points = fibonacci_points(50)
    for number, residual in enumerate((0.5, 0.1, 0.3)):
        keeper(Iterate(number, residual, 1.0, points))
        points = points[::-1]
    assert keeper.save()
    np.testing.assert_array_equal(CheckpointKeeper(tmp_path / "c.npz", REQUEST).load(), fibonacci_points(50)[::-1])
    keeper.remove()
    assert list(tmp_path.iterdir()) == []


def test_other_checkpoints_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "c.npz"
    with pytest.raises(MeshError, match="there is no checkpoint"):
        CheckpointKeeper(path, REQUEST).load()
    keeper = CheckpointKeeper(path, REQUEST)
    keeper(Iterate(0, 1.0, 1.0, fibonacci_points(50)))
    keeper.save()
    with pytest.raises(MeshError, match="made with cells = 50, not 60"):
        CheckpointKeeper(path, MeshRequest(60)).load()
    path.write_bytes(path.read_bytes()[:100])
    with pytest.raises(MeshError, match="not a readable checkpoint"):
        CheckpointKeeper(path, REQUEST).load()
