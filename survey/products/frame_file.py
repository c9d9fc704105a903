"""One immutable file a frame: its points and what became of every pixel."""

from __future__ import annotations

import io
import zipfile
import zlib
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from survey.cloud.points import PixelRecord, PointCloud
from survey.cloud.raw import RawReadings
from survey.products.writing import write_whole


@dataclass(frozen=True, kw_only=True)
class FrameResult:
    """What one flash gave.

    Parameters
    ----------
    bottom, surface : PointCloud
        Points of the frame.
    record : PixelRecord
        Truth and outcome of every pixel.
    raw : RawReadings, optional
        What the detector put out, where the scenario keeps it; `read_raw` reads it back.
    """

    bottom: PointCloud
    surface: PointCloud
    record: PixelRecord
    raw: RawReadings | None = None


def frame_bytes(result: FrameResult) -> bytes:
    """Return the content of a frame's file: a zip of arrays, the same bytes for the same frame."""
    arrays: dict[str, Any] = {}
    for part, columns in (("bottom", result.bottom), ("surface", result.surface)):
        arrays |= {f"{part}_{name}": column for name, column in columns.columns().items()}
    for field in fields(PixelRecord):
        arrays[f"pixel_{field.name}"] = getattr(result.record, field.name)
    if result.raw is not None:
        for field in fields(RawReadings):
            arrays[f"raw_{field.name}"] = getattr(result.raw, field.name)
    content = io.BytesIO()
    np.savez_compressed(content, **arrays)
    return content.getvalue()


def write_frame(path: Path, result: FrameResult) -> bytes:
    """Write a frame whole, and return its bytes."""
    content = frame_bytes(result)
    write_whole(path, content)
    return content


def read_frame(path: Path) -> FrameResult:
    """Read a frame that `write_frame` wrote, without the detector's raw output.

    Raises
    ------
    ValueError
        When the file is not whole.
    """
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
            return FrameResult(
                bottom=PointCloud(**_part(arrays, "bottom")),
                surface=PointCloud(**_part(arrays, "surface")),
                record=PixelRecord(**_part(arrays, "pixel")),
            )
    except (zipfile.BadZipFile, zlib.error, EOFError, TypeError, ValueError) as fault:
        raise ValueError(f"{path}: not a whole frame ({fault}). Delete it and run again") from None


def read_raw(path: Path) -> RawReadings | None:
    """Read what the detector put out from a frame's file; None where it was not kept.

    ``processing.keep_waveforms`` says whether a run keeps it.
    """
    with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
        part = _part(arrays, "raw")
    return RawReadings(**part) if part else None


def _part(arrays: Any, prefix: str) -> dict[str, Any]:
    start = len(prefix) + 1
    return {name[start:]: arrays[name] for name in arrays.files if name.startswith(f"{prefix}_")}
