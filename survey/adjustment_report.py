"""What strip adjustment found, as JSON and as text."""

from __future__ import annotations

from typing import Any

import numpy as np

from survey.adjustment import AdjustedRun, pooled_rms
from survey.cloud.strip_adjustment import RESOLVED
from survey.cloud.strip_unknowns import ANGLES, AXES, LEVER_ARM, RANGING

DECIMALS = 5


def as_json(run: AdjustedRun) -> dict[str, Any]:
    """Return everything that was solved, with standard errors and truth beside it."""
    found = run.adjustment
    return {
        "mode": found.unknowns.mode,
        "mounting": _mounting(run),
        "lines": _lines(run),
        "pairs": [
            {
                "lines": list(pair.lines),
                "matches": pair.matches,
                "residual_shift_m": _rounded(pair.shift),
                "residual_shift_error_m": _rounded(pair.shift_error),
                "information_per_m2": _rounded(pair.information),
            }
            for pair in found.pairs
        ],
        "noise": {
            "deviation_m": _rounded(found.noise.deviation),
            "block_variance_ratio": _rounded(found.noise.blocks),
            "frame_up_m": _rounded(found.noise.frame),
        },
        "before": _accuracy(run, "before"),
        "after": _accuracy(run, "after"),
        "overlaps_before": run.overlaps_before,
        "overlaps_after": run.overlaps_after,
    }


def _mounting(run: AdjustedRun) -> list[dict[str, Any]]:
    found, rows = run.adjustment, []
    for i, name in enumerate(found.unknowns.common):
        if name in RANGING:
            continue
        angle = name in ANGLES
        unit = "deg" if angle else "m"
        scale = np.degrees(1.0 / found.unknowns.arms[i]) if angle else 1.0
        true = (
            np.degrees(getattr(run.mounting, name))
            if angle
            else run.mounting.lever_arm[LEVER_ARM.index(name)]
        )
        rows.append(
            {
                "name": f"{name}_{unit}",
                "correction": _rounded(found.values[i] * scale),
                "standard_error": _rounded(found.errors[i] * scale),
                "resolved": _rounded(found.resolved[i]),
                "determined": bool(found.resolved[i] >= RESOLVED),
                "true": _rounded(true),
            }
        )
    return rows


def _lines(run: AdjustedRun) -> list[dict[str, Any]]:
    found = run.adjustment
    parts = [found.unknowns.offsets(p) for p in (found.values, found.errors, found.resolved)]
    return [
        {
            "line": line,
            "offset_m": _rounded(values),
            "standard_error_m": _rounded(errors),
            "determined": [a for a, s in zip(AXES, shares, strict=True) if s >= RESOLVED],
            "true_offset_m": _rounded(true),
        }
        for line, values, errors, shares, true in zip(
            found.unknowns.lines, *parts, run.offsets, strict=True
        )
    ]


def _accuracy(run: AdjustedRun, when: str) -> dict[str, Any]:
    against, pairs = getattr(run, when), getattr(run, f"overlaps_{when}")
    return {
        "points": against.points,
        "rms_horizontal_error_m": _rounded(against.horizontal),
        "rms_elevation_error_m": _rounded(against.elevation),
        "rms_strip_difference_m": _rounded(pooled_rms(pairs)),
    }


def _rounded(value: Any) -> Any:
    return np.round(np.asarray(value, dtype=np.float64), DECIMALS).tolist()


def as_text(run: AdjustedRun) -> str:
    """Return it in a few lines for the user."""
    told, lines = as_json(run), []
    for row in told["mounting"]:
        if row["determined"]:
            solved = f"{row['correction']:+.3f} +- {row['standard_error']:.3f}"
            lines.append(f"{row['name']:12}  {solved}   truly {row['true']:+.3f}")
        else:
            lines.append(f"{row['name']:12}  not told by these overlaps, left alone")
    for row in told["lines"]:
        values, errors, true = (
            row[key] for key in ("offset_m", "standard_error_m", "true_offset_m")
        )
        parts = [
            f"{axis} {value:+.3f} +- {error:.3f} (truly {real:+.3f})"
            if axis in row["determined"]
            else f"{axis} not told"
            for axis, value, error, real in zip(AXES, values, errors, true, strict=True)
        ]
        lines.append(f"line {row['line']:<7}  " + ", ".join(parts) + " m")
    for words, key in (
        ("strips differ by", "rms_strip_difference_m"),
        ("bottom errs along and across by", "rms_horizontal_error_m"),
        ("bottom errs in elevation by", "rms_elevation_error_m"),
    ):
        lines.append(
            f"{words} {told['before'][key]:.3f} m, now {told['after'][key]:.3f} m (r.m.s.)"
        )
    return "\n".join(lines)
