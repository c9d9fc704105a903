"""JSON as everybody reads it: no NaN, no Infinity, same bytes every time."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from survey.products.writing import require_read_back, whole_file


def json_bytes(data: Mapping[str, Any]) -> bytes:
    r"""Return indented UTF-8 JSON in the order given.

    Raises
    ------
    ValueError
        If a number is NaN or infinite.

    Examples
    --------
    >>> json_bytes({"frames": 2})
    b'{\n  "frames": 2\n}\n'
    """
    return (json.dumps(data, indent=2, allow_nan=False, ensure_ascii=False) + "\n").encode()


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """Write a mapping of plain values as one whole JSON file.

    Raises
    ------
    ValueError
        If a number is NaN or infinite.
    ReadBackError
        If the file does not read back as written.
    """
    content = json_bytes(data)
    with whole_file(path) as partial:
        partial.write_bytes(content)
        require_read_back(path, "values", json.loads(partial.read_bytes()) == dict(data))
