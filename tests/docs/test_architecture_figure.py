"""The picture of the rooms shows those that there are."""

import architecture_figure
from tests.test_architecture import ROOMS


def test_the_picture_has_the_rooms_in_their_order() -> None:
    drawn = {package: list(rooms) for package, rooms in architecture_figure.ROOMS.items()}
    assert drawn == {package: [room for room in rooms if room] for package, rooms in ROOMS.items()}


def test_the_stations_are_rooms_and_none_comes_twice() -> None:
    rooms = {(package, room) for package, names in ROOMS.items() for room in names}
    for path in (architecture_figure.POINTS, architecture_figure.THICKNESS):
        assert set(path) <= rooms
        assert len(set(path)) == len(path)
    figure = architecture_figure.architecture_figure()
    texts = {text.get_text() for text in figure.axes[0].texts}
    assert {str(station) for station in range(1, 10)} <= texts
    assert {room for names in ROOMS.values() for room in names if room} <= texts
    bottom, top = figure.axes[0].get_ylim()
    assert all(
        bottom < text.get_position()[1] < top - 0.5 * architecture_figure.HEIGHT for text in figure.axes[0].texts
    )
