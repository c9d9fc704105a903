"""The findings as plain values with units in the keys, for `paper.json`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.paper import instrument
from survey.paper.curves import Curves, curves
from survey.paper.fit import Depths, Fit
from survey.paper.power import FOOTPRINT
from survey.paper.receiver import PaperReceiver
from survey.paper.reproduce import Findings
from survey.paper.single_element import Sight, sentences
from survey.paper.verdict import (
    DEAD_TIME,
    F_NUMBER,
    FILTER_INDEX,
    SPAD_SIDE,
    buildable,
    field_corner,
    spad_etendue,
)
from survey.transport.response_walks import FLOOD, ISOLATED

MADE_BY = "bathyflash paper"
DIGITS = 6


def as_json(findings: Findings, *, work: float, seed: int) -> dict[str, Any]:
    """Return all that the command finds; depths are of the water column's backscatter.

    Parameters
    ----------
    findings : Findings
    work : float
        Walks over those of the full computation [1].
    seed : int
    """
    receiver = findings.isolated.receiver
    return {
        "made_by": MADE_BY,
        "of": "A. A. Lisenko, A. I. Potekaev, V. S. Shamanaev, Russian Physics Journal (2017)",
        "work": work,
        "seed": seed,
        **_fit(findings.isolated),
        "curves": _all_curves(findings, receiver, ISOLATED),
        "flood": {
            **_fit(findings.flood),
            "depths_with_receiver_of_isolated": _rounded(findings.flood_same_receiver),
            "curves": _all_curves(findings, findings.flood.receiver, FLOOD),
        },
        "apparent_depth": {
            "reading": "the paper's depth taken as c t / 2, that is index times geometric depth",
            **_fit(findings.apparent),
        },
        "verdict": _verdict(findings),
        "single_element": _single_element(findings.sights),
        "assumed": {
            "quantum_efficiency": instrument.EFFICIENCY,
            "internal_noise_per_s": instrument.INTERNAL_NOISE,
            "wind_speed_m_s": instrument.WIND_SPEED,
            "pixel_side_at_surface_m": FOOTPRINT.side,
            "pixel_growth_per_m": round(FOOTPRINT.growth, DIGITS),
        },
    }


def _fit(found: Fit) -> dict[str, Any]:
    return {
        "depths": _rounded(found.depths),
        "depths_sem_m": _rounded(found.errors),
        "published": instrument.PUBLISHED,
        "residual_percent": _rounded(found.residuals, scale=100.0),
        "rms_percent": _short(100.0 * found.rms),
        "worst_percent": _short(100.0 * found.worst),
        "receiver": {
            **_receiver(found.receiver),
            "aperture_radius_sem_m": _short(found.radius_error),
            "filter_width_sem_nm": _short(found.width_error * 1e9),
        },
    }


def _receiver(receiver: PaperReceiver) -> dict[str, float]:
    sun = receiver.background_rate(instrument.SUNS["day"])
    return {
        "aperture_radius_m": _short(receiver.aperture_radius),
        "filter_width_nm": _short(receiver.filter_width * 1e9),
        "quantum_efficiency_assumed": receiver.efficiency,
        "etendue_m2_sr": _short(receiver.etendue),
        "background_counts_per_gate": _short(sun * instrument.MEASURING_TIME),
    }


def _all_curves(
    findings: Findings, receiver: PaperReceiver, illumination: int
) -> dict[str, dict[str, Any]]:
    return {
        name: {
            "absorption_per_m": light.water.absorption,
            "scattering_per_m": light.water.scattering,
            **_curves(curves(light, receiver, illumination=illumination)),
        }
        for name, light in findings.lights.items()
    }


def _curves(found: Curves) -> dict[str, Any]:
    return {
        "depth_m": _list(found.depth),
        "power_w": _list(found.power),
        "power_sem_w": _list(found.power_error),
        "snr": {f"{sun:g}": _list(values) for sun, values in found.snr.items()},
        "snr_sem": {f"{sun:g}": _list(values) for sun, values in found.snr_error.items()},
    }


def _verdict(findings: Findings) -> dict[str, Any]:
    verdict, other = findings.verdict, buildable()
    return {
        "can_exist": verdict.can_exist,
        "etendue_ratio": _short(verdict.etendue_ratio),
        "spad_etendue_m2_sr": _short(spad_etendue()),
        "spad_side_um_assumed": SPAD_SIDE * 1e6,
        "f_number_assumed": F_NUMBER,
        "field_corner_deg": _short(np.degrees(field_corner())),
        "filter_shift_nm": _short(verdict.filter_shift * 1e9),
        "filter_index_assumed": FILTER_INDEX,
        "sun_counts_per_dead_time": _short(verdict.sun_per_dead_time),
        "dead_time_ns_assumed": DEAD_TIME * 1e9,
        "surface_counts_per_gate": _short(verdict.surface_per_gate),
        "sentences": verdict.sentences(),
        "buildable": {
            **_receiver(other),
            "depths": _rounded(findings.buildable_depths),
        },
    }


def _single_element(sights: dict[str, dict[str, Sight]]) -> dict[str, Any]:
    return {
        "sentences": sentences(sights),
        "noise": "sun, and the column at the bottom's depth as if there were no bottom",
        **{
            name: {water: _sight(sight) for water, sight in waters.items()}
            for name, waters in sights.items()
        },
    }


def _sight(sight: Sight) -> dict[str, Any]:
    return {
        "limit_optical_depth": {sun: _short(value) for sun, value in sight.limit.items()},
        "bottom_as_bright_as_column_at": None if sight.even is None else _short(sight.even),
        "optical_depth": _list(sight.optical_depth),
        "snr": {sun: _list(values) for sun, values in sight.snr.items()},
        "snr_sem": {sun: _list(values) for sun, values in sight.snr_error.items()},
        "bottom_over_column": _list(sight.contrast),
    }


def _rounded(depths: Depths, *, scale: float = 1.0) -> Depths:
    return {
        sun: {name: _short(scale * value) for name, value in waters.items()}
        for sun, waters in depths.items()
    }


def _list(values: NDArray[np.float64]) -> list[float]:
    return [_short(value) for value in values]


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
