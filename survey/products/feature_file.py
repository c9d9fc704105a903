"""GeoJSON written feature by feature: a long mission has millions of them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any
from zlib import crc32

from survey.products.writing import require_read_back, whole_file

HEAD, TAIL = '{\n  "type": "FeatureCollection",\n  "features": [', "]\n}\n"
MARGIN = "\n    "
BYTES_AT_ONCE = 1 << 24


def write_features(path: Path, features: Iterable[Mapping[str, Any]]) -> None:
    """Write a feature collection, of which memory holds one feature at a time.

    The bytes are those of `json_bytes` for the whole collection.

    Parameters
    ----------
    path : Path
    features : iterable of mapping
        Taken one after another.

    Raises
    ------
    ValueError
        If a number is NaN or infinite.
    ReadBackError
        If the file does not read back as written.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "places.geojson"
    >>> write_features(path, iter([{"type": "Feature"}]))
    >>> json.loads(path.read_text())
    {'type': 'FeatureCollection', 'features': [{'type': 'Feature'}]}
    """
    checksum = 0
    with whole_file(path) as partial:
        with partial.open("wb") as file:

            def write(text: str) -> None:
                nonlocal checksum
                content = text.encode()
                checksum = crc32(content, checksum)
                file.write(content)

            write(HEAD)
            separator = ""
            for feature in features:
                text = json.dumps(feature, indent=2, allow_nan=False, ensure_ascii=False)
                write(separator + MARGIN + text.replace("\n", MARGIN))
                separator = ","
            write(("\n  " if separator else "") + TAIL)
        require_read_back(path, "bytes", _checksum(partial) == checksum)


def _checksum(path: Path) -> int:
    checksum = 0
    with path.open("rb") as file:
        while content := file.read(BYTES_AT_ONCE):
            checksum = crc32(content, checksum)
    return checksum
