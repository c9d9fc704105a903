"""A first look at a LAS or LAZ file, before a reader trusts the counts in its header."""

from __future__ import annotations

import struct
from pathlib import Path

from terrain.foreign.faults import ReaderError

SMALLEST_HEADER = 227  # [bytes] of LAS 1.0 to 1.2
HEADER_OF_1_4 = 375  # [bytes]
RECORD_HEADER = 54  # [bytes] before the contents of a variable length record
EXTENDED_RECORD_HEADER = 60  # [bytes]
SIZES = struct.Struct("<HIIBHI")  # from byte 94 on
SIZES_OF_1_4 = struct.Struct("<QIQ")  # from byte 235 on: extended records, points
COMPRESSED = 0x80  # bit of the point format in a LAZ file


def require_plausible_header(path: Path) -> None:
    """Refuse a header whose sizes do not fit into the file.

    Source: ASPRS LAS 1.4 specification R15, table 3. A reader that believes such counts can be
    busy for minutes.

    Raises
    ------
    ReaderError
        When it is no LAS file or the header contradicts the size of the file.
    """
    size = path.stat().st_size
    with path.open("rb") as source:
        head = source.read(HEADER_OF_1_4)
    if head[:4] != b"LASF" or len(head) < SMALLEST_HEADER:
        raise ReaderError(
            "not a readable LAS or LAZ file: fetch or export it again. It has no LAS header"
        )
    if not _fits(head, size):
        raise ReaderError(
            "not a readable LAS or LAZ file. the sizes in its header contradict its "
            f"{size} bytes. it may be cut short: fetch it again"
        )


def _fits(head: bytes, size: int) -> bool:
    header, to_points, records, point_format, point, points = SIZES.unpack_from(head, 94)
    if head[24] != 1 or not SMALLEST_HEADER <= header <= to_points <= size:
        return False
    if head[25] >= 4 and len(head) >= HEADER_OF_1_4:
        extended_start, extended, points = SIZES_OF_1_4.unpack_from(head, 235)
        if extended and extended_start + EXTENDED_RECORD_HEADER * extended > size:
            return False
    if header + RECORD_HEADER * records > to_points:
        return False
    return bool(point_format & COMPRESSED) or to_points + point * points <= size
