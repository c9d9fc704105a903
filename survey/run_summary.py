"""What a run achieved, in a few lines for the user."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from survey.products.verdict.words import verdict_lines


def summary(folder: Path, metrics: Mapping[str, Any]) -> str:
    """Return what a run achieved in a few lines for the user."""
    return "\n".join(
        (
            *_set_aside([frame["frame"] for frame in metrics["frames_set_aside"]]),
            f"{metrics['points_bottom']} bottom points, {metrics['points_surface']} surface points",
            f"bottom against the true seabed: bias {_metres(metrics['bias_m'])}, "
            f"95 % within {_metres(metrics['p95_abs_error_m'])}, "
            f"false bottoms {metrics['false_bottoms']}",
            f"uncertainty, 95 %: vertical {_metres(metrics['tvu_median_m'])} holds for "
            f"{_share(metrics['tvu_coverage'])}, horizontal {_metres(metrics['thu_median_m'])} for "
            f"{_share(metrics['thu_coverage'])} of the points",
            *verdict_lines(metrics),
            f"written to {folder}: report.html, bottom.laz, bathymetry.tif and others",
        )
    )


def _set_aside(frames: Sequence[int]) -> Sequence[str]:
    """Return a line on the frames that are missing, if there are any.

    Examples
    --------
    >>> _set_aside([7, 12])
    ['set aside after three tries, and missing from all products: frames 7, 12']
    """
    if not frames:
        return []
    numbers = ", ".join(map(str, frames))
    return [f"set aside after three tries, and missing from all products: frames {numbers}"]


def _metres(value: object) -> str:
    return f"{value:.3f} m" if isinstance(value, float) else "not measured"


def _share(value: object) -> str:
    return f"{100.0 * value:.1f} %" if isinstance(value, float) else "none"
