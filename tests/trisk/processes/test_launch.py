"""What launchers say in the environment."""

import pytest

from trisk.processes.launch import Launch, launch_of


@pytest.mark.parametrize(
    ("environment", "launch"),
    [
        ({}, Launch(0, 1)),
        ({"PMI_RANK": "2", "PMI_SIZE": "3"}, Launch(2, 3)),
        ({"OMPI_COMM_WORLD_RANK": "0", "OMPI_COMM_WORLD_SIZE": "4"}, Launch(0, 4)),
        ({"PMI_RANK": "2"}, Launch(0, 1)),
        ({"PMI_RANK": "two", "PMI_SIZE": "three"}, Launch(0, 1)),
    ],
)
def test_launchers_are_known(environment: dict[str, str], launch: Launch) -> None:
    assert launch_of(environment) == launch


def test_the_first_speaks() -> None:
    assert [Launch(rank, 3).first for rank in range(3)] == [True, False, False]
