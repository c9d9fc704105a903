"""One immutable file a frame: its points and what became of every pixel."""

from __future__ import annotations

import io
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
    """Return the content of a frame's file: the same bytes for the same frame.

    A zip of ``bottom.npy``, ``surface.npy``, ``pixel.npy`` and, where it was kept, ``raw.npy``.
    Each holds one record whose fields are whole columns, and `numpy.load` reads it. Only the last
    is deflated: of the others that would take a third off the size and double the reading time.
    """
    parts: dict[str, Mapping[str, Any]] = {
        "bottom": result.bottom.columns(),
        "surface": result.surface.columns(),
        "pixel": {field.name: getattr(result.record, field.name) for field in fields(PixelRecord)},
    }
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
    except (zipfile.BadZipFile, zlib.error, EOFError, KeyError, TypeError, ValueError) as fault:
        raise ValueError(f"{path}: not a whole frame ({fault}). Delete it and run again") from None


def read_raw(path: Path) -> RawReadings | None:
    """Read what the detector put out from a frame's file; None where it was not kept.

    ``processing.keep_waveforms`` says whether a run keeps it.
    """
    with path.open("rb") as file, np.load(file, allow_pickle=False) as arrays:
        return RawReadings(**_part(arrays, "raw")) if "raw" in arrays else None


def _part(arrays: Mapping[str, NDArray[np.void]], name: str) -> dict[str, NDArray[Any]]:
    record = arrays[name]
    return {column: record[column] for column in record.dtype.names or ()}
