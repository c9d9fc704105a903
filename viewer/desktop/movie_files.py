"""Files of moving pictures: written under another name, and given theirs when they are whole."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.errors import UserError

Picture = NDArray[np.uint8]
MILLISECONDS = 1000.0
QUALITY = "23"
"""Of x264, its constant rate factor: its own middle."""


@dataclass(frozen=True, kw_only=True)
class Format:
    """A kind of movie.

    Parameters
    ----------
    size : (width, height)
        Of its pictures [pixels].
    rate : float
        Pictures a second [Hz].
    write : callable
        Writes pictures (height, width, 3) to a path at a rate.
    """

    size: tuple[int, int]
    rate: float
    write: Callable[[Path, Iterable[Picture], float], None]


def write_gif(path: Path, pictures: Iterable[Picture], rate: float) -> None:
    """Write pictures as an endless GIF, one after the other."""
    from PIL import Image

    images = (Image.fromarray(picture).quantize(128) for picture in pictures)
    first = next(images)
    first.save(
        path,
        format="GIF",
        save_all=True,
        append_images=images,
        duration=MILLISECONDS / rate,
        loop=0,
    )


def write_mp4(path: Path, pictures: Iterable[Picture], rate: float) -> None:
    """Write pictures as MP4 (H.264, as all browsers and players show it) by the program ffmpeg.

    Raises
    ------
    UserError
        If ffmpeg gives up, in its own words.
    """
    source = iter(pictures)
    first = next(source)
    command = _ffmpeg(path, size=(first.shape[1], first.shape[0]), rate=rate)
    with tempfile.TemporaryFile() as words:
        with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=words) as ffmpeg:
            _pour(ffmpeg, chain([first], source))
        if ffmpeg.returncode:
            words.seek(0)
            last = words.read().decode(errors="replace").strip().splitlines()[-1:]
            raise UserError(f"{path}: ffmpeg gave up: {' '.join(last)}. Name a GIF instead")


def format_of(file: Path) -> Format:
    """Return the kind of movie that a file's ending names, once it is sure that it can be written.

    Raises
    ------
    UserError
        If the ending is another, there is no place for the file, or ffmpeg is missing.

    Examples
    --------
    >>> format_of(Path("wreck.avi"))
    Traceback (most recent call last):
    survey.errors.UserError: wreck.avi: no movie. Name a file that ends in .mp4 or .gif
    """
    kind = FORMATS.get(file.suffix.lower())
    if kind is None:
        raise UserError(f"{file}: no movie. Name a file that ends in .mp4 or .gif")
    if file.is_dir():
        raise UserError(f"{file}: is a folder. Name a file that ends in .mp4 or .gif")
    if not file.parent.is_dir():
        raise UserError(f"{file}: no folder {file.parent}. Make it first")
    if kind.write is write_mp4 and shutil.which("ffmpeg") is None:
        raise UserError(
            f"{file}: MP4 is written by the program ffmpeg, and it is not here. On Debian or "
            "Ubuntu type: apt-get install -y ffmpeg. Or name a file that ends in .gif"
        )
    return kind


def _ffmpeg(path: Path, *, size: tuple[int, int], rate: float) -> list[str]:
    taken = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{size[0]}x{size[1]}"]
    made = ["-c:v", "libx264", "-crf", QUALITY, "-pix_fmt", "yuv420p", "-movflags", "+faststart"]
    quiet = ["ffmpeg", "-v", "error", "-y"]
    return [*quiet, *taken, "-r", f"{rate:g}", "-i", "-", *made, "-f", "mp4", str(path)]


def _pour(ffmpeg: subprocess.Popen[bytes], pictures: Iterable[Picture]) -> None:
    """Give a program pictures until it has had enough: a pipe that breaks tells in its status."""
    with suppress(BrokenPipeError):
        for picture in pictures:
            assert ffmpeg.stdin is not None
            ffmpeg.stdin.write(picture.tobytes())


FORMATS = {
    ".mp4": Format(size=(1280, 720), rate=25.0, write=write_mp4),
    ".gif": Format(size=(800, 450), rate=10.0, write=write_gif),
}
