"""A score as a table."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

COLUMNS = ("depth", "points", "bias", "rmse", "95 %", "false", "detectable", "missed")
FIGURES = ("bias_m", "rmse_m", "p95_abs_error_m")


def as_text(found: Mapping[str, Any]) -> str:
    """Return the score as lines for the terminal."""
    return "\n".join(
        (
            *_heading(found),
            "",
            "".join(f"{name:>11}" for name in COLUMNS),
            *(_row(_depths(row), row) for row in found["by_depth"]),
            _row("all", found["all_depths"]),
            "",
            *_confusion(found["confusion"]),
            *(f"note: {note}" for note in found["notes"]),
        )
    )


def _heading(found: Mapping[str, Any]) -> Iterator[str]:
    benchmark = found["benchmark"]
    yield (
        f"{found['cloud']} against {benchmark['title']}: seed {benchmark['seed']}, "
        f"{benchmark['frames']} frames, scenario {benchmark['scenario_sha256'][:12]}, "
        f"code {benchmark['code_sha256'][:12]}"
    )
    yield (
        f"{found['points']} points, {found['points_claiming_bottom']} claim to be bottom, "
        f"{found['points_off_the_known_seabed']} of these off the known seabed; metres, measured "
        f"less true; missed: no right bottom point within {found['cell_m']:g} m"
    )


def _depths(row: Mapping[str, Any]) -> str:
    if row["from_depth_m"] < 0.0:
        return "land"
    return f"{row['from_depth_m']:.0f}-{row['to_depth_m']:.0f} m"


def _row(name: str, row: Mapping[str, Any]) -> str:
    figures = ("" if row[key] is None else f"{row[key]:.3f}" for key in FIGURES)
    counts = (row["false_bottoms"], row["detectable"], row["missed_bottoms"])
    return "".join(f"{cell:>11}" for cell in (name, row["points"], *figures, *counts))


def _confusion(table: Mapping[str, Mapping[str, int]]) -> Iterator[str]:
    truths = [
        name for name in next(iter(table.values())) if any(row[name] for row in table.values())
    ]
    width = max(len(name) for name in (*table, "class in the cloud"))
    yield f"{'class in the cloud':{width}}  " + "  ".join(name.replace("_", " ") for name in truths)
    for name, row in table.items():
        cells = (f"{row[truth]:>{len(truth)}}" for truth in truths)
        yield f"{name:{width}}  " + "  ".join(cells)
