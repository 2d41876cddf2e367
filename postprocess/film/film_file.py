"""Frames into a file: MP4 by ffmpeg, of the package imageio-ffmpeg, or GIF by Pillow."""

from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from mesh.safe_files import written_aside
from postprocess.film.stencil import Pixels
from swe.errors import InputError

QUALITY = 18
"""Constant rate factor of H.264, at which the eye sees no loss."""

GREYS = 16
"""Colours of a GIF, of its 256, that are left to letters and lines."""


def require_kind(path: Path, size: tuple[int, int]) -> None:
    """Raise `InputError` unless a film of `size` (width, height) can be written to `path`."""
    if path.suffix not in (".mp4", ".gif"):
        raise InputError(f"{path} is no film; end its name in .mp4 or .gif")
    if path.suffix == ".mp4":
        _ffmpeg()
        if size[0] % 2 or size[1] % 2:
            raise InputError(f"an MP4 film cannot have {size[0]} x {size[1]} pixels; give even numbers")


def write_film(
    path: Path, frames: Iterator[Pixels], size: tuple[int, int], frames_per_second: float, colours: Pixels
) -> None:
    """Write frames of `size` (width, height) to `path`, which appears when it is whole.

    `colours` (n, 3) are those of the values, for files that hold few colours.
    """
    with written_aside(path) as aside:
        if path.suffix == ".mp4":
            _write_mp4(aside, frames, size, frames_per_second)
        else:
            _write_gif(aside, frames, frames_per_second, colours)


def _write_mp4(path: Path, frames: Iterator[Pixels], size: tuple[int, int], frames_per_second: float) -> None:
    writer = _ffmpeg().write_frames(
        str(path),
        size,
        fps=frames_per_second,
        codec="libx264",
        quality=None,
        macro_block_size=2,
        # Films of two or three frames are no reason to warn.
        ffmpeg_log_level="error",
        # The temporary name does not tell the format; the index goes first, so that browsers can begin at once.
        output_params=["-crf", str(QUALITY), "-f", "mp4", "-movflags", "+faststart"],
    )
    try:
        writer.send(None)
        for frame in frames:
            writer.send(frame)
    finally:
        writer.close()


def _write_gif(path: Path, frames: Iterator[Pixels], frames_per_second: float, colours: Pixels) -> None:
    palette = Image.new("P", (1, 1))
    of_values = colours[np.linspace(0, len(colours) - 1, 256 - GREYS).astype(int)]
    greys = np.repeat(np.linspace(0, 255, GREYS).astype(np.uint8)[:, None], 3, axis=1)
    palette.putpalette(np.concatenate([of_values, greys]).tobytes())
    images = (Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    first = next(images)
    first.save(
        path,
        format="GIF",
        save_all=True,
        append_images=images,
        duration=1000.0 / frames_per_second,
        loop=0,
    )


def _ffmpeg() -> Any:
    try:
        return import_module("imageio_ffmpeg")
    except ImportError as missing:
        raise InputError(
            "an MP4 film is written by the package imageio-ffmpeg, which is missing; install it with "
            "pip install 'trisk[film]', or write a .gif"
        ) from missing
