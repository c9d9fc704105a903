"""One immutable file a frame: its points and what became of every pixel."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PixelRecord, PointCloud
from survey.cloud.raw import RawReadings


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
    candidates : PointCloud, optional
        Weak echoes of pixels without a bottom, which other frames may make bottoms.
    helped : int
        How many of the bottom points other frames have made so; not in the file.
    """

    bottom: PointCloud
    surface: PointCloud
    record: PixelRecord
    raw: RawReadings | None = None
    candidates: PointCloud | None = None
    helped: int = 0


def frame_bytes(result: FrameResult) -> bytes:
    """Return the content of a frame's file: the same bytes for the same frame.

    A zip of ``bottom.npy``, ``surface.npy``, ``pixel.npy`` and, where there are any,
    ``candidates.npy`` and ``raw.npy``. Each holds one record whose fields are whole columns, and
    `numpy.load` reads it. Only the last is deflated: of the others that would take a third off the
    size and double the reading time.
    """
    parts: dict[str, Mapping[str, Any]] = {
        "bottom": result.bottom.columns(),
        "surface": result.surface.columns(),
        "pixel": {field.name: getattr(result.record, field.name) for field in fields(PixelRecord)},
    }
    if result.candidates is not None:
        parts["candidates"] = result.candidates.columns()
    if result.raw is not None:
        parts["raw"] = {
            field.name: getattr(result.raw, field.name) for field in fields(RawReadings)
        }
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name, columns in parts.items():
            member, packed = zipfile.ZipInfo(f"{name}.npy"), io.BytesIO()
            np.save(packed, _record(columns))
            way = zipfile.ZIP_DEFLATED if name == "raw" else zipfile.ZIP_STORED
            archive.writestr(member, packed.getvalue(), way)
    return content.getvalue()


def _record(columns: Mapping[str, Any]) -> NDArray[np.void]:
    kinds = [(name, column.dtype, column.shape) for name, column in columns.items()]
    record = np.zeros((), np.dtype(kinds, align=True))
    for name, column in columns.items():
        record[name] = column
    return record


def read_frame(path: Path) -> FrameResult:
    """Read a frame's file of `frame_bytes`, without the detector's raw output.

    Raises
    ------
    ValueError
        When the file is not whole.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            weak = "candidates.npy" in archive.namelist()
            return FrameResult(
                bottom=PointCloud(**_columns(archive, "bottom")),
                surface=PointCloud(**_columns(archive, "surface")),
                record=PixelRecord(**_columns(archive, "pixel")),
                candidates=PointCloud(**_columns(archive, "candidates")) if weak else None,
            )
    except (zipfile.BadZipFile, zlib.error, EOFError, KeyError, TypeError, ValueError) as fault:
        raise ValueError(f"{path}: not a whole frame ({fault}). Delete it and run again") from None


def read_raw(path: Path) -> RawReadings | None:
    """Read what the detector put out from a frame's file; None where it was not kept.

    ``processing.keep_waveforms`` says whether a run keeps it.
    """
    with zipfile.ZipFile(path) as archive:
        kept = "raw.npy" in archive.namelist()
        return RawReadings(**_columns(archive, "raw")) if kept else None


def _columns(archive: zipfile.ZipFile, name: str) -> dict[str, NDArray[Any]]:
    content = archive.read(f"{name}.npy")
    start = len(np.lib.format.MAGIC_PREFIX) + 4 + int.from_bytes(content[8:10], "little")
    kind = _kind(content[:start])
    if kind.itemsize == 0:
        record = np.zeros((), kind)
    else:
        (record,) = np.frombuffer(content, kind, offset=start, count=1)
    return {column: record[column] for column in kind.names or ()}


@lru_cache(maxsize=64)
def _kind(header: bytes) -> np.dtype[np.void]:
    """Return the type of a record: frames of a mission share a few, which take long to parse."""
    file = io.BytesIO(header)
    np.lib.format.read_magic(file)
    _, _, kind = np.lib.format.read_array_header_1_0(file)
    return kind
