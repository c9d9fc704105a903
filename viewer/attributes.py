"""What points can be coloured by, the same in the window and on the page: words, units, colours."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Cause, Outcome, PointClass, PointCloud
from survey.products.depth_colours import COLOURS, depth_range
from survey.products.report.maps import STATE_LOOKS
from terrain.substrate import UNLABELLED

FloatArray = NDArray[np.float64]
SHADES = 64
DIVERGING = ("#0072b2", "#c4c8cc", "#d55e00")
CATEGORIES = (
    *("#0072b2", "#e69f00", "#009e73", "#d55e00", "#cc79a7", "#56b4e9", "#8a7f00", "#5b4ea3"),
    *("#7f7f7f", "#1b1b1b"),
)
"""Mostly those of Okabe and Ito (2008), told apart by the colour-blind."""

NO_VALUE = "#9aa0a6"
LEAST_SNR = 0.1


@dataclass(frozen=True, kw_only=True)
class Scale:
    """How numbers become colours.

    Parameters
    ----------
    low, high : float
        Ends, in the attribute's unit; values beyond take the colours of the ends.
    palette : tuple of str
        Colours from low to high.
    logarithmic : bool
        Ratios are shown so.
    land : bool
        Values of 0 and less are land and have its colour.
    """

    low: float
    high: float
    palette: tuple[str, ...]
    logarithmic: bool = False
    land: bool = False


@dataclass(frozen=True, kw_only=True)
class Category:
    """One kind of points: its code, words and colour, and how many there are."""

    code: int
    label: str
    colour: str
    count: int


@dataclass(frozen=True, kw_only=True)
class Attribute:
    """What points are coloured by: by a scale, or by categories.

    Parameters
    ----------
    name : str
        In files and in keys.
    label, unit : str
        For the legend; 1 has the empty string for its unit.
    scale : Scale, optional
    categories : tuple of Category
        Without a scale.
    """

    name: str
    label: str
    unit: str = ""
    scale: Scale | None = None
    categories: tuple[Category, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Measure:
    """A length of every point.

    Parameters
    ----------
    name, short : str
        In the file, and in a sentence.
    label : str
        For the legend.
    values : callable
        From a cloud, (n,) [m].
    colours : str
        Name of a colour map; the empty string stands for blue, grey, red about 0.
    """

    name: str
    short: str
    label: str
    values: Callable[[PointCloud], FloatArray]
    colours: str


def elevation_error(cloud: PointCloud) -> FloatArray:
    """Return measured less true elevation at the measured place (n,) [m]."""
    return np.asarray(cloud.position[:, 2] - cloud.true_elevation)


MEASURES = (
    Measure(
        name="error",
        short="error",
        label="Error, measured less true elevation",
        values=elevation_error,
        colours="",
    ),
    Measure(
        name="tvu",
        short="TVU",
        label="Vertical uncertainty, 95 % (TVU)",
        values=lambda cloud: cloud.tvu.astype(np.float64),
        colours="cividis_r",
    ),
    Measure(
        name="thu",
        short="THU",
        label="Horizontal uncertainty, 95 % (THU)",
        values=lambda cloud: cloud.thu.astype(np.float64),
        colours="cividis_r",
    ),
)


def measure_attribute(measure: Measure, values: FloatArray) -> Attribute:
    """Return how a measure with such values is shown."""
    low, high = _range(values[np.isfinite(values)], diverging=not measure.colours)
    scale = Scale(low=low, high=high, palette=palette(measure.colours))
    return Attribute(name=measure.name, label=measure.label, unit="m", scale=scale)


def depth_attribute(depth: FloatArray) -> Attribute:
    """Return how depth is shown: as on the maps of a run, shallow bright and deep dark."""
    low, high = depth_range(depth)
    scale = Scale(low=low, high=high, palette=palette(COLOURS), land=bool((depth <= 0.0).any()))
    return Attribute(name="depth", label="Depth below the water level", unit="m", scale=scale)


def snr_attribute(snr: NDArray[np.float32]) -> Attribute:
    """Return how signal-to-noise ratios are shown; 0 stands for none."""
    found = snr[snr > 0.0]
    low, high = np.percentile(found, [0.5, 99.5]) if found.size else (1.0, 10.0)
    low = max(float(low), LEAST_SNR)
    scale = Scale(
        low=float(f"{low:.2g}"),
        high=float(f"{max(high, 1.5 * low):.2g}"),
        palette=palette("cividis"),
        logarithmic=True,
    )
    return Attribute(name="snr", label="Signal-to-noise ratio of the echo", scale=scale)


def frame_attribute(frames: NDArray[np.integer]) -> Attribute:
    """Return how the number of the frame is shown."""
    low = int(frames.min())
    scale = Scale(low=low, high=max(int(frames.max()), low + 1), palette=palette("viridis"))
    return Attribute(name="frame", label="Frame, in the order of flight", scale=scale)


def categories_of(cloud: PointCloud, substrates: Mapping[int, str]) -> list[Attribute]:
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


def outcome_attribute(outcomes: NDArray[np.uint8]) -> Attribute:
    """Return how what became of the bottom is shown, in the colours of the report's maps."""
    found, counts = np.unique(outcomes, return_counts=True)
    looks = [STATE_LOOKS[Outcome(code)] for code in found]
    return Attribute(
        name="outcome",
        label="What became of the bottom, cause of holes",
        categories=tuple(
            Category(code=int(code), label=label, colour=colour, count=int(count))
            for code, count, (label, colour) in zip(found, counts, looks, strict=True)
        ),
    )


def palette(name: str) -> tuple[str, ...]:
    """Return the colours of a scale, low to high; the empty name is blue, grey, red.

    Examples
    --------
    >>> palette("viridis")[0], palette("")[0], len(palette(""))
    ('#440154', '#0072b2', 64)
    """
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap, to_hex

    colours = colormaps[name] if name else LinearSegmentedColormap.from_list("error", DIVERGING)
    return tuple(to_hex(colours(share)) for share in np.linspace(0.0, 1.0, SHADES))


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


def _range(finite: FloatArray, *, diverging: bool) -> tuple[float, float]:
    """Return the ends of a scale between which nearly all values lie."""
    if finite.size == 0:
        return 0.0, 1.0
    if diverging:
        end = round_up(max(float(np.percentile(np.abs(finite), 98.0)), 0.01))
        return -end, end
    low, high = np.percentile(finite, [0.5, 98.0])
    step = round_up(max((high - low) / 10.0, 0.001))
    start = np.floor(low / step) * step
    end = max(np.ceil(high / step), np.floor(low / step) + 1) * step
    return float(f"{start:.6g}"), float(f"{end:.6g}")


def _category(
    name: str, label: str, codes: NDArray[np.integer], words: Mapping[int, str]
) -> Attribute:
    found, counts = np.unique(codes, return_counts=True)
    return Attribute(
        name=name,
        label=label,
        categories=tuple(
            Category(
                code=int(code),
                label=words.get(int(code), str(code)),
                colour=CATEGORIES[place % len(CATEGORIES)],
                count=int(count),
            )
            for place, (code, count) in enumerate(zip(found, counts, strict=True))
        ),
    )
