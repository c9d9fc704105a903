"""What a page does not show, or shows less exactly than the run, in sentences."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from viewer.attributes import MEASURES
from viewer.web.attributes import SNR_STEP, STEPS
from viewer.web.points import HORIZONTAL_STEP, VERTICAL_STEP, Chosen
from viewer.web.waveforms import LEAST_LIGHT, LIGHT_STEP

NAMES = {
    "bottom": "points of bottom, objects and ground",
    "other": "pixels without a bottom, and noise",
    "surface": "points of the sea surface",
}


def left_out(
    chosen: Mapping[str, Chosen],
    *,
    waveforms: Mapping[str, Any] | None,
    seabed: Mapping[str, Any] | None,
) -> list[str]:
    """Return one sentence for each kind of points, each rounding, and what is missing."""
    return [
        *(_points(kind, NAMES[name]) for name, kind in chosen.items()),
        f"Places are rounded to {HORIZONTAL_STEP * 100:g} cm, heights to "
        f"{VERTICAL_STEP * 1000:g} mm.",
        _roundings(),
        "Of each point's other columns none is here: reflectance, counts, uncorrected and true "
        "place stand in bottom.ply.",
        _waveforms(waveforms),
        _seabed(seabed),
    ]


def _roundings() -> str:
    steps = ", ".join(
        f"{measure.short} to {STEPS[measure.name] * 1000:g} mm" for measure in MEASURES
    )
    return f"Rounded are {steps}, signal-to-noise ratio within {100 * SNR_STEP / 2:g} %."


def _points(kind: Chosen, words: str) -> str:
    shown = len(kind.cloud)
    if shown == kind.of:
        return f"All {shown:,} {words} are here." if shown else f"The run has no {words}."
    return f"{shown:,} of {kind.of:,} {words} are here, drawn by lot."


def _waveforms(found: Mapping[str, Any] | None) -> str:
    if found is None:
        return "No waveforms are here: bathyflash waveforms RUN --pixel draws any one."
    frames = sorted({pixel["frame"] for pixel in found["pixels"]})
    return (
        f"Waveforms of {len(found['pixels'])} marked pixels of {len(frames)} frames are here, "
        f"light rounded within {100 * LIGHT_STEP / 2:g} % "
        f"and left out below {LEAST_LIGHT:g} photo-electrons a bin."
    )


def _seabed(found: Mapping[str, Any] | None) -> str:
    if found is None:
        return "The true seabed is not here."
    return f"The true seabed is drawn every {found['cell']:g} m; finer shape and overhangs are not."
