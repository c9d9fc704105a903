"""What the points of a page can be coloured by: values, units, rounding and colours."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Cause, PointClass, PointCloud
from survey.products.depth_colours import COLOURS, LAND, depth_range
from terrain.substrate import UNLABELLED
from viewer.web.columns import IntArray, logarithmic, rounded, start_of

FloatArray = NDArray[np.float64]
SHADES = 64
DIVERGING = ("#0072b2", "#c4c8cc", "#d55e00")
CATEGORIES = (
    *("#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#8a7f00", "#5b4ea3"),
    *("#7f7f7f", "#1b1b1b"),
)
"""Mostly those of Okabe and Ito (2008), told apart by the colour-blind."""

LEAST_SNR, SNR_STEP = 0.1, 0.04


@dataclass(frozen=True, kw_only=True)
class Measure:
    """A number of every point.

    Parameters
    ----------
    name, short : str
        In the file, and in a sentence.
    label, unit : str
        For the legend.
    values : callable
        From a cloud, (n,).
    step : float
        To which it is rounded.
    colours : str
        Name of a colour map; the empty string stands for blue, grey, red about 0.
    """

    name: str
    short: str
    label: str
    unit: str
    values: Callable[[PointCloud], FloatArray]
    step: float
    colours: str


def elevation_error(cloud: PointCloud) -> FloatArray:
    """Return measured less true elevation at the measured place (n,) [m]."""
    return np.asarray(cloud.position[:, 2] - cloud.true_elevation)


MEASURES = (
    Measure(
        name="error",
        short="error",
        label="Error, measured less true elevation",
        unit="m",
        values=elevation_error,
        step=0.005,
        colours="",
    ),
    Measure(
        name="tvu",
        short="TVU",
        label="Vertical uncertainty, 95 % (TVU)",
        unit="m",
        values=lambda cloud: cloud.tvu.astype(np.float64),
        step=0.005,
        colours="cividis_r",
    ),
    Measure(
        name="thu",
        short="THU",
        label="Horizontal uncertainty, 95 % (THU)",
        unit="m",
        values=lambda cloud: cloud.thu.astype(np.float64),
        step=0.01,
        colours="cividis_r",
    ),
)


def measures_of(cloud: PointCloud) -> tuple[dict[str, IntArray], list[dict[str, Any]]]:
    """Return columns of a cloud in whole steps, and how the page is to show them."""
    columns = {m.name: rounded(m.values(cloud), m.step) for m in MEASURES}
    columns["snr"] = logarithmic(cloud.snr, least=LEAST_SNR, step=SNR_STEP)
    shown = [_shown(measure, measure.values(cloud)) for measure in MEASURES]
    return columns, [*shown, _snr(cloud)]


def depth_attribute(depth: FloatArray) -> dict[str, Any]:
    """Return how depth is shown, as on the maps of a run; the page takes it from the places."""
    low, high = depth_range(depth)
    return {
        "name": "depth",
        "label": "Depth below the water level",
        "unit": "m",
        "range": [low, high],
        "palette": palette(COLOURS),
        "below": {"colour": LAND, "label": "land"} if (depth <= 0.0).any() else None,
    }


def frame_attribute(frames: NDArray[Any]) -> dict[str, Any]:
    """Return how the number of the frame is shown."""
    return {
        "name": "frame",
        "label": "Frame, in the order of flight",
        "unit": "",
        "range": [int(frames.min()), max(int(frames.max()), int(frames.min()) + 1)],
        "palette": palette("viridis"),
    }


def categories_of(cloud: PointCloud, substrates: Mapping[int, str]) -> list[dict[str, Any]]:
    """Return how class, cause, substrate and line of the points are shown, with their counts."""
    classes = {
        int(kind): f"{kind.name.lower().replace('_', ' ')} ({kind:d})" for kind in PointClass
    }
    causes = {int(cause): cause.name.lower().replace("_", " ") for cause in Cause}
    return [
        _category("class", "Class (LAS)", cloud.classification, classes),
        _category("cause", "What moved the point most", cloud.cause, causes),
        _category(
            "substrate",
            "What the bottom is made of",
            cloud.substrate,
            {UNLABELLED: "unlabelled", **substrates},
        ),
        _category("line", "Survey line", cloud.line, {}),
    ]


def palette(name: str) -> list[str]:
    """Return the colours of a scale, low to high; the empty name is blue, grey, red.

    Examples
    --------
    >>> palette("viridis")[0], palette("")[0], len(palette(""))
    ('#440154', '#0072b2', 64)
    """
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap, to_hex

    colours = colormaps[name] if name else LinearSegmentedColormap.from_list("error", DIVERGING)
    return [to_hex(colours(share)) for share in np.linspace(0.0, 1.0, SHADES)]


def round_up(value: float) -> float:
    """Return the next of 1, 2 or 5 times a power of ten.

    Examples
    --------
    >>> round_up(0.13), round_up(2.0), round_up(6.1)
    (0.2, 2.0, 10.0)
    """
    power = 10.0 ** np.floor(np.log10(value))
    steps = (float(f"{step * power:.6g}") for step in (1.0, 2.0, 5.0, 10.0))
    return next(step for step in steps if value <= step * (1.0 + 1e-9))


def _shown(measure: Measure, values: FloatArray) -> dict[str, Any]:
    finite = values[np.isfinite(values)]
    return {
        "name": measure.name,
        "label": measure.label,
        "unit": measure.unit,
        "range": _range(finite, diverging=not measure.colours),
        "palette": palette(measure.colours),
        "step": measure.step,
        "start": start_of(values, measure.step),
    }


def _range(finite: FloatArray, *, diverging: bool) -> list[float]:
    """Return the ends of a scale between which nearly all values lie."""
    if finite.size == 0:
        return [0.0, 1.0]
    if diverging:
        end = round_up(max(float(np.percentile(np.abs(finite), 98.0)), 0.01))
        return [-end, end]
    low, high = np.percentile(finite, [0.5, 98.0])
    step = round_up(max((high - low) / 10.0, 0.001))
    ends = np.floor(low / step) * step, max(np.ceil(high / step), np.floor(low / step) + 1) * step
    return [float(f"{end:.6g}") for end in ends]


def _snr(cloud: PointCloud) -> dict[str, Any]:
    found = cloud.snr[cloud.snr > 0.0]
    low, high = np.percentile(found, [0.5, 99.5]) if found.size else (1.0, 10.0)
    low = max(float(low), LEAST_SNR)
    return {
        "name": "snr",
        "label": "Signal-to-noise ratio of the echo",
        "unit": "",
        "range": [float(f"{low:.2g}"), float(f"{max(high, 1.5 * low):.2g}")],
        "palette": palette("cividis"),
        "least": LEAST_SNR,
        "ratio": 1.0 + SNR_STEP,
    }


def _category(
    name: str, label: str, codes: NDArray[Any], words: Mapping[int, str]
) -> dict[str, Any]:
    found, counts = np.unique(codes, return_counts=True)
    return {
        "name": name,
        "label": label,
        "categories": [
            {
                "code": int(code),
                "label": words.get(int(code), str(code)),
                "colour": CATEGORIES[place % len(CATEGORIES)],
                "count": int(count),
            }
            for place, (code, count) in enumerate(zip(found, counts, strict=True))
        ],
    }
