"""Tables written out as TOML."""

from __future__ import annotations

import json
from collections.abc import Mapping
from datetime import datetime
from typing import Any


def to_toml(tables: Mapping[str, Any]) -> str:
    """Return TOML that reads back as the same tables; keys without a value are left out.

    A table within a section stands in one line.

    Examples
    --------
    >>> print(to_toml({"water": {"type": "clear", "absorption_per_m": None, "n": 1.0}}))
    [water]
    type = "clear"
    n = 1.0
    <BLANKLINE>
    """
    return "\n".join(_table(name, table) for name, table in tables.items())


def _table(name: str, table: Mapping[str, Any]) -> str:
    plain = {key: value for key, value in table.items() if not _is_array_of_tables(value)}
    lines = [f"[{name}]"]
    lines += [f"{key} = {_value(value)}" for key, value in plain.items() if value is not None]
    for key, entries in table.items():
        if key not in plain:
            for entry in entries:
                lines += ["", f"[[{name}.{key}]]"]
                lines += [f"{k} = {_value(v)}" for k, v in entry.items() if v is not None]
    return "\n".join(lines) + "\n"


def _is_array_of_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, datetime):
        return value.isoformat().replace("+00:00", "Z")
    if isinstance(value, list):
        return f"[{', '.join(_value(entry) for entry in value)}]"
    if isinstance(value, Mapping):
        pairs = (f"{k} = {_value(v)}" for k, v in value.items() if v is not None)
        return f"{{{', '.join(pairs)}}}"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value)
