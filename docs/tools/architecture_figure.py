"""Draw docs/figures/architecture.png: python docs/tools/architecture_figure.py docs/figures/architecture.png."""

import sys
from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

ROOMS = {
    "mesh": (
        "geometry",
        "triangulation",
        "density",
        "regions",
        "integrals",
        "discrete",
        "overlap",
        "parts",
        "partition",
        "generation",
        "coast",
        "plane",
        "polygon",
        "files",
    ),
    "swe": ("parallel", "equations", "forcing", "tiles", "damping", "diagnostics", "stepping", "output", "run"),
    "cases": ("plane", "finding"),
    "postprocess": (
        "runs",
        "reference",
        "compare",
        "figures",
        "film",
        "view",
        "convert",
        "studies",
        "reports",
        "adaptation",
        "interactive",
    ),
    "trisk": ("processes", "report", "arguments", "cli", "mesh_cli", "results_cli"),
}
"""Rooms of each package in the order of imports, the lowest first, as `tests/test_architecture.py` holds it."""

Room = tuple[str, str]

POINTS: tuple[Room, ...] = (
    ("mesh", "generation"),
    ("mesh", "triangulation"),
    ("mesh", "integrals"),
    ("mesh", "discrete"),
    ("mesh", "files"),
)
THICKNESS: tuple[Room, ...] = (
    ("cases", "finding"),
    ("swe", "run"),
    ("swe", "equations"),
    ("swe", "tiles"),
    ("swe", "stepping"),
    ("swe", "diagnostics"),
    ("swe", "output"),
    ("postprocess", "runs"),
    ("postprocess", "figures"),
)
WIDTH, HEIGHT, GAP = 2.1, 0.55, 0.35
BESIDE = 0.22
"""Distance of numbers from the box, so that they cover no letters."""


def center(room: Room) -> tuple[float, float]:
    """Middle of the box of a room."""
    package, name = room
    column = list(ROOMS).index(package)
    row = ROOMS[package].index(name) if name else 0
    return column * (WIDTH + 2.0 * GAP), row * (HEIGHT + GAP)


def draw_room(axes: Axes, room: Room) -> None:
    """A box with the name of the room, or of the package where that has no rooms."""
    x, y = center(room)
    box = FancyBboxPatch(
        (x - WIDTH / 2, y - HEIGHT / 2), WIDTH, HEIGHT, boxstyle="round,pad=0.03", facecolor="#eef2f7", edgecolor="0.5"
    )
    axes.add_patch(box)
    axes.text(x, y, room[1] or "one module\na paper", ha="center", va="center", fontsize=9)


def draw_path(axes: Axes, path: Sequence[Room], colour: str, side: int) -> None:
    """Numbers of the stations of a path, at the left (-1) or right (1) side of the rooms."""
    for station, room in enumerate(path, 1):
        x, y = center(room)
        badge = {"boxstyle": "circle,pad=0.3", "facecolor": colour, "edgecolor": "none"}
        beside = x + side * (WIDTH / 2 + BESIDE)
        axes.text(beside, y, str(station), color="white", fontsize=9, ha="center", va="center", bbox=badge)


def architecture_figure() -> Figure:
    """All rooms, each above those that it may import, and the stations of the two paths through them."""
    figure = Figure(figsize=(11.0, 8.0), layout="constrained")
    axes = figure.subplots()
    for package, rooms in ROOMS.items():
        for name in rooms or ("",):
            draw_room(axes, (package, name))
        x, _ = center((package, rooms[0] if rooms else ""))
        axes.text(x, -0.75, package, ha="center", va="center", fontsize=12, fontweight="bold")
    draw_path(axes, POINTS, "#c8641e", -1)
    draw_path(axes, THICKNESS, "#1f5fa8", 1)
    for number, (text, colour) in enumerate(
        (("points, from their start to a file", "#c8641e"), ("thickness, from the case to a picture", "#1f5fa8"))
    ):
        axes.text(1.55 * (WIDTH + 2 * GAP), 9.9 - 0.45 * number, text, color=colour, ha="center", fontsize=10)
    axes.set_xlim(-1.6, 4 * (WIDTH + 2.0 * GAP) + 1.1)
    axes.set_ylim(-1.1, (max(map(len, ROOMS.values())) - 1) * (HEIGHT + GAP) + 0.6)
    axes.set_aspect("equal")
    axes.axis("off")
    return figure


if __name__ == "__main__":
    architecture_figure().savefig(Path(sys.argv[1]), dpi=110, metadata={"Software": None})
