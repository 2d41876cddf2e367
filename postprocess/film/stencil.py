"""A map as a stencil: which value each pixel shows, and what else is drawn there."""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import Collection
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from mesh.arrays import Index

Pixels = NDArray[np.uint8]
"""Red, green and blue (rows, columns, 3) from 0 to 255, the top row first."""


@dataclass(frozen=True, eq=False)
class Stencil:
    """A picture without its values.

    `shown` (rows, columns) numbers the value that each pixel shows. A pixel is `ink` (rows, columns, 3), what is drawn
    round and over the values, plus the colour of its value times `share` (rows, columns, 3), from 0 to 255.
    """

    shown: Index
    ink: Pixels
    share: Pixels

    def picture(self, colours: Pixels) -> Pixels:
        """The picture (rows, columns, 3) with these colours (n_values, 3) of the values."""
        of_values = np.take(colours, self.shown, axis=0).astype(np.uint16)
        of_values *= self.share
        of_values += 127
        of_values //= 255
        of_values += self.ink
        return of_values.astype(np.uint8)


def stencil_of(axes: Axes) -> Stencil:
    """The stencil of the figure of `axes`, whose last collection has as its array the numbers of the values it shows.

    Uses the figure up.
    """
    figure, drawn = axes.get_figure(root=True), axes.collections[-1]
    assert figure is not None
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # else the map would move when its frame is taken away
    numbers = np.asarray(drawn.get_array(), dtype=np.int64)
    drawn.set_array(None)
    # What shows through is the difference between the picture with white values and that with black ones.
    ink, light = (_rendered_with(figure, drawn, colour) for colour in ("black", "white"))
    share = light - np.minimum(light, ink)
    return Stencil(_numbers_at_pixels(figure, axes, drawn, numbers), ink, share)


def _rendered_with(figure: Figure, drawn: Collection, colour: str) -> Pixels:
    # Sides of a pixel's width leave no hairlines between neighbours.
    drawn.set(facecolor=colour, edgecolor="face", linewidth=1.0)
    return _rendered(figure)


def _rendered(figure: Figure) -> Pixels:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _numbers_at_pixels(figure: Figure, axes: Axes, drawn: Collection, numbers: Index) -> Index:
    """Draw each number as a colour of its own, without anti-aliasing and without all else, and read it back."""
    for artist in (*figure.get_children(), *axes.get_children()):
        artist.set_visible(artist in (axes, drawn))
    digits = np.stack([(numbers + 1) >> shift & 255 for shift in (16, 8, 0)], axis=-1)
    drawn.set_clip_path(None)  # a rim would be blended
    drawn.set(facecolor=digits / 255.0, edgecolor="none", linewidth=0.0, antialiased=False)
    axes.set_axis_off()
    red, green, blue = np.moveaxis(_rendered_on_black(figure).astype(np.int64), -1, 0)
    found = (red << 16 | green << 8 | blue) - 1
    # Pixels between neighbours that neither covers take the nearest number.
    nearest = distance_transform_edt(found < 0, return_distances=False, return_indices=True)
    return np.ascontiguousarray(found[tuple(nearest)])


def _rendered_on_black(figure: Figure) -> Pixels:
    figure.patch.set(visible=True, facecolor="black")
    return _rendered(figure)
