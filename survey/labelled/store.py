"""Data sets of waveforms on the disk: zarr folders that are whole or absent.

Zarr reads chunks that were never written as zeros, without a word. So every chunk is written, the
folder is read back under a temporary name before it takes its own, and opening one counts its
chunks. The format is zarr 2 with its metadata in one place: what every reader of zarr knows.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from survey.errors import UserError
from survey.products.writing import require_read_back

if TYPE_CHECKING:
    import xarray

CHUNK_BYTES = 8 << 20
BLOCK_BYTES = 128 << 20
VARIABLES_BY_BIN = 8
BYTES_OF_A_BIN = 4
FRAMES_OF_A_SCALAR = 4096
TAGS_OF_A_CHUNK = 1 << 20
ZSTD_LEVEL = 5
FORMAT: Final = 2
FRAMES_ATTRIBUTE = "frames"


@dataclass(frozen=True, kw_only=True)
class Layout:
    """How many frames are held in memory, and how the arrays are cut.

    Parameters
    ----------
    block : int
        Frames that are written at once.
    chunk : int
        Frames of a chunk of waveforms; divides `block`.
    rows : int
        Rows of such a chunk.
    """

    block: int
    chunk: int
    rows: int

    @classmethod
    def of(cls, *, frames: int, rows: int, columns: int, bins: int) -> Layout:
        """Return chunks of about 8 MiB and blocks of about 128 MiB, of one frame at least.

        Examples
        --------
        >>> Layout.of(frames=16000, rows=32, columns=64, bins=300)
        Layout(block=6, chunk=3, rows=32)
        >>> Layout.of(frames=16000, rows=4, columns=8, bins=300)
        Layout(block=436, chunk=218, rows=4)
        """
        row = columns * bins * BYTES_OF_A_BIN
        chunk = min(max(CHUNK_BYTES // (rows * row), 1), frames)
        chunks = BLOCK_BYTES // (VARIABLES_BY_BIN * rows * row * chunk)
        return cls(
            block=chunk * max(chunks, 1), chunk=chunk, rows=min(max(CHUNK_BYTES // row, 1), rows)
        )


def write_blocks(path: Path, blocks: Iterable[xarray.Dataset], *, layout: Layout) -> None:
    """Write data sets of frames one after the other into a new folder, and read all of it back.

    Parameters
    ----------
    path : Path
        The folder; not there yet.
    blocks : iterable of xarray.Dataset
        Each of ``layout.block`` frames, the last of fewer.
    layout : Layout

    Raises
    ------
    ReadBackError
        If what is read back is not what was written.
    """
    import zarr

    written = _Written()
    for block in blocks:
        frames, tags = _split(block)
        if not written.frames:
            frames = frames.assign_attrs({FRAMES_ATTRIBUTE: 0})
            _begin(path, frames, layout)
            if tags is not None:
                _begin(path, tags, layout, mode="a")
        else:
            per_frame = [name for name, part in frames.variables.items() if "frame" in part.dims]
            _append(path, frames[per_frame], "frame")
            if tags is not None:
                _append(path, tags, "tag")
        written.note(frames, tags)
    group = zarr.open_group(path, mode="r+")
    group.attrs[FRAMES_ATTRIBUTE] = sum(written.sizes)
    zarr.consolidate_metadata(path, zarr_format=FORMAT)
    _require_same(path, written)


def open_waveforms(path: Path, *, chunks: Any = "auto") -> xarray.Dataset:
    """Open a folder of labelled waveforms that is whole; arrays are read when they are used.

    Parameters
    ----------
    path : Path
    chunks : optional
        As in `xarray.open_zarr`: None opens it without dask.

    Raises
    ------
    FileNotFoundError
        When there is no such folder.
    UserError
        When it holds something else, or a chunk of it is missing.
    """
    import xarray

    if not path.exists():
        raise FileNotFoundError(2, "No such file or directory", str(path))
    fault = _fault(path)
    if fault:
        raise UserError(f"{path}: not a whole set of waveforms: {fault}. Write it again")
    found: xarray.Dataset = xarray.open_zarr(path, chunks=chunks)
    return found


def _fault(path: Path) -> str:
    """Return what is wrong with a folder; nothing where it is whole."""
    import zarr

    try:
        group = zarr.open_group(path, mode="r", zarr_format=FORMAT, use_consolidated=True)
        count = group.attrs.get(FRAMES_ATTRIBUTE)
        arrays = dict(group.arrays())
        for name, array in arrays.items():
            missing = array.nchunks - array.nchunks_initialized
            if missing:
                return f"{name}: {missing} of {array.nchunks} chunks are missing"
        if "counts" not in arrays or count != arrays["counts"].shape[0]:
            return "it is of another kind"
    except (OSError, ValueError, KeyError) as error:
        return f"{type(error).__name__}, no zarr of ours"
    return ""


@dataclass
class _Written:
    """Digests of what was written, by block."""

    frames: list[str] = field(default_factory=list)
    tags: list[str] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    tag_sizes: list[int] = field(default_factory=list)

    def note(self, frames: xarray.Dataset, tags: xarray.Dataset | None) -> None:
        self.frames.append(_digest(frames))
        self.sizes.append(frames.sizes["frame"])
        if tags is not None:
            self.tags.append(_digest(tags))
            self.tag_sizes.append(tags.sizes["tag"])


def _require_same(path: Path, written: _Written) -> None:
    found = open_waveforms(path, chunks=None)
    frames, tags = _split(found)
    for part, dim, digests, sizes in (
        (frames, "frame", written.frames, written.sizes),
        (tags, "tag", written.tags, written.tag_sizes),
    ):
        if part is None:
            require_read_back(path, dim, not digests)
            continue
        require_read_back(path, f"{dim}s", part.sizes[dim] == sum(sizes))
        for digest, piece in zip(digests, _pieces(sizes), strict=True):
            require_read_back(path, f"{dim}s", _digest(part.isel({dim: piece})) == digest)


def _pieces(sizes: list[int]) -> Iterator[slice]:
    start = 0
    for size in sizes:
        yield slice(start, start + size)
        start += size


def _split(block: xarray.Dataset) -> tuple[xarray.Dataset, xarray.Dataset | None]:
    """Return what belongs to frames, and the time tags if there are any."""
    names = [name for name, part in block.variables.items() if "tag" in part.dims]
    if not names:
        return block, None
    return block.drop_vars(names), block[names].reset_coords(drop=True)


def _digest(part: xarray.Dataset) -> str:
    digest = hashlib.sha256()
    for name in sorted(map(str, part.variables)):
        values = np.ascontiguousarray(part[name].values)
        digest.update(f"{name} {values.dtype.str} {values.shape}".encode())
        digest.update(values.view(np.uint8).data if values.ndim else values.tobytes())
    return digest.hexdigest()


def _begin(path: Path, part: xarray.Dataset, layout: Layout, *, mode: Any = "w-") -> None:
    encoding = {str(name): _encoding(piece, layout) for name, piece in part.variables.items()}
    part.to_zarr(
        path,
        mode=mode,
        encoding=encoding,
        consolidated=False,
        zarr_format=FORMAT,
        write_empty_chunks=True,
    )


def _append(path: Path, part: xarray.Dataset, dim: str) -> None:
    part.to_zarr(
        path, append_dim=dim, consolidated=False, zarr_format=FORMAT, write_empty_chunks=True
    )


def _encoding(piece: Any, layout: Layout) -> dict[str, Any]:
    """Return how a variable is stored: bytes of like weight together, then zstd."""
    from numcodecs import Shuffle, Zstd

    encoding: dict[str, Any] = {
        "compressors": Zstd(level=ZSTD_LEVEL),
        "filters": [Shuffle(elementsize=piece.dtype.itemsize)],
    }
    if piece.dims:
        encoding["chunks"] = _chunks(piece, layout)
    if piece.dtype.kind == "M":
        start = piece.values[0].astype("datetime64[D]")
        encoding |= {"units": f"seconds since {start}", "dtype": "f8", "_FillValue": None}
    if piece.dtype.kind == "f" and piece.dims in (("bin",), ("layer",)):
        encoding["_FillValue"] = None
    return encoding


def _chunks(piece: Any, layout: Layout) -> tuple[int, ...]:
    if piece.dims == ("tag",):
        return (TAGS_OF_A_CHUNK,)
    if piece.dims == ("frame",):
        return (FRAMES_OF_A_SCALAR,)
    if "frame" not in piece.dims:
        return tuple(piece.shape)
    if "bin" not in piece.dims:
        return (layout.block, *piece.shape[1:])
    return (layout.chunk, layout.rows, *piece.shape[2:])
