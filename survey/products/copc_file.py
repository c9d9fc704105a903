"""A LAZ file as cloud-optimised point cloud (COPC 1.0): an octree whose nodes are LAZ chunks.

https://copc.io: viewers fetch the coarse nodes first and then those in sight.
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from survey.products.writing import require_read_back, whole_file

if TYPE_CHECKING:
    import laspy

IntArray = NDArray[np.int64]
CELLS_PER_NODE = 128
"""Along an edge of a node; at most one point of each cell stays in it, the rest go deeper."""

DEEPEST = 20
INFO = struct.Struct("<5d2Q2d88x")
ENTRY = struct.Struct("<4iQ2i")
LONG_RECORD = struct.Struct("<H16sHQ32s")


def write_copc(path: Path, las: laspy.LasData) -> None:
    """Write points (format 6 to 8) as COPC, node by node, all their fields untouched.

    Within a node points keep the order of the source. Everything is in memory at once.

    Parameters
    ----------
    path : Path
        File to write, ending in ``.copc.laz``.
    las : laspy.LasData
        One point or more; its header's records, such as CRS and extra bytes, are kept.

    Raises
    ------
    ReadBackError
        If the file does not read back as written.
    """
    import laspy

    places = np.stack([las.X, las.Y, las.Z], axis=1).astype(np.int64)
    low, side = _cube(places)
    nodes = octree(places - low, side)
    with whole_file(path) as partial:
        with partial.open("wb") as file:
            _write(file, las, nodes, low, side)
        with laspy.CopcReader.open(str(partial)) as again:
            found = again.query()
            same = _sorted(found.array) == _sorted(las.points.array)
        require_read_back(path, "points", same)


def octree(places: IntArray, side: int) -> dict[tuple[int, int, int, int], NDArray[np.intp]]:
    """Return the points of every node by its key: level, x, y, z.

    The first point in each of 128 x 128 x 128 cells of a node stays, the others go one level
    deeper; those on the deepest level all stay.

    Parameters
    ----------
    places : array (n, 3)
        From the lower corner of the root, in steps.
    side : int
        Of the root, in steps, a power of two above every place.

    Examples
    --------
    >>> nodes = octree(np.array([[0, 0, 0], [0, 0, 1], [900, 0, 0]]), 1024)
    >>> {key: points.tolist() for key, points in nodes.items()}
    {(0, 0, 0, 0): [0, 2], (1, 0, 0, 0): [1]}
    """
    nodes = {}
    left = np.arange(len(places))
    for level in range(DEEPEST + 1):
        if left.size == 0:
            break
        node = places[left] // max(side >> level, 1)
        chosen = np.ones(left.size, np.bool_)
        if level < DEEPEST:
            cell = places[left] // max((side >> level) // CELLS_PER_NODE, 1)
            chosen[:] = False
            chosen[np.unique(cell, axis=0, return_index=True)[1]] = True
        keys, owner = np.unique(node[chosen], axis=0, return_inverse=True)
        order = np.argsort(owner.ravel(), kind="stable")
        ends = np.cumsum(np.bincount(owner.ravel()))
        groups = np.split(left[chosen][order], ends[:-1])
        for (x, y, z), points in zip(keys.tolist(), groups, strict=True):
            nodes[level, x, y, z] = points
        left = left[~chosen]
    return nodes


def _cube(places: IntArray) -> tuple[IntArray, int]:
    """Return the lower corner and the side of the root, a power of two, in steps."""
    low = places.min(axis=0)
    extent = int((places.max(axis=0) - low).max())
    return low, 1 << max(extent.bit_length(), 10)


def _write(
    file: BinaryIO,
    las: laspy.LasData,
    nodes: dict[tuple[int, int, int, int], NDArray[np.intp]],
    low: IntArray,
    side: int,
) -> None:
    import lazrs
    from laspy.vlrs.known import LasZipVlr
    from laspy.vlrs.vlr import VLR

    header = las.header
    packing = lazrs.LazVlr.new_for_compression(
        header.point_format.id, header.point_format.num_extra_bytes, True
    )
    about = VLR("copc", 1, "COPC info", bytes(INFO.size))
    kept = [record for record in header.vlrs if not isinstance(record, LasZipVlr)]
    header.vlrs[:] = [about, *kept, LasZipVlr(packing.record_data())]
    header.update(las.points)
    header.are_points_compressed = True
    header.write_to(file)
    packer = lazrs.LasZipCompressor(file, packing)
    for number, points in enumerate(nodes.values()):
        if number > 0:
            packer.finish_current_chunk()
        packer.compress_many(np.frombuffer(las.points.array[points].tobytes(), np.uint8))
    packer.done()
    hierarchy = file.tell() + LONG_RECORD.size
    _write_hierarchy(file, nodes, _chunks(file, header.offset_to_point_data, packing))
    about.record_data = INFO.pack(
        *(header.offsets + (low + side / 2) * header.scales),
        side / 2 * header.scales[0],
        side / CELLS_PER_NODE * header.scales[0],
        *(hierarchy, len(nodes) * ENTRY.size),
        *(float(las.gps_time.min()), float(las.gps_time.max())),
    )
    header.start_of_first_evlr = hierarchy - LONG_RECORD.size
    header.number_of_evlrs = 1
    file.seek(0)
    header.write_to(file, ensure_same_size=True)


def _chunks(file: BinaryIO, start: int, packing: Any) -> list[tuple[int, int]]:
    """Return offset and size of every chunk [bytes]."""
    import lazrs

    with Path(file.name).open("rb") as written:
        file.flush()
        written.seek(start)
        sizes = [size for _, size in lazrs.read_chunk_table(written, packing)]
        first = written.tell()
    ends = np.cumsum(sizes).tolist()
    return [(first + end - size, size) for end, size in zip(ends, sizes, strict=True)]


def _write_hierarchy(
    file: BinaryIO,
    nodes: dict[tuple[int, int, int, int], NDArray[np.intp]],
    chunks: list[tuple[int, int]],
) -> None:
    entries = b"".join(
        ENTRY.pack(*key, *chunk, len(points))
        for (key, points), chunk in zip(nodes.items(), chunks, strict=True)
    )
    file.write(LONG_RECORD.pack(0, b"copc", 1000, len(entries), b"EPT Hierarchy"))
    file.write(entries)


def _sorted(records: NDArray[np.void]) -> bytes:
    """Return the bytes of records in an order of their own."""
    rows = np.ascontiguousarray(records).view(f"V{records.dtype.itemsize}")
    return np.sort(rows.view(f"S{records.dtype.itemsize}")).tobytes()
