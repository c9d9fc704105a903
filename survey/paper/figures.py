"""Figures 1-3 of the paper and the comparison with a single element, as PNG and SVG."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.paper import instrument
from survey.paper.curves import SHOWN_TO, Curves, curves
from survey.paper.figure_single import draw_single_element
from survey.paper.fit import Fit
from survey.paper.receiver import PaperReceiver
from survey.paper.reproduce import Findings
from survey.transport.response_walks import FLOOD, ISOLATED

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FloatArray = NDArray[np.float64]

DOTS_PER_INCH = 130
KINDS = ("png", "svg")
SETTLED = 0.25  # a curve is drawn to where its standard error is this share of it [1]
POWER_RANGE = (1e-15, 1.0)
SNR_RANGE = (1e-2, 1e10)
COLOURS = ("#440154", "#3b528b", "#21918c", "#5ec962", "#e6a700", "#d55e00")
COLUMN, NEIGHBOURS, LEVEL = "#0072b2", "#9a9a9a", "#555555"
WATER_WORDS = {"P02": "clear ocean", "P05": "coastal ocean", "P07": "turbid harbor"}


def pictures(findings: Findings) -> dict[str, bytes]:
    """Return every picture as PNG and SVG by its file's name, bytes alike from run to run."""
    from matplotlib import rc_context

    contents = {}
    with rc_context({"svg.hashsalt": "bathyflash"}):
        drawn = {
            f"figure{number}": draw_water(findings, name, number)
            for number, name in enumerate(instrument.WATERS, start=1)
        }
        drawn["single_element"] = draw_single_element(findings.sights)
        for name, figure in drawn.items():
            figure.draw_without_rendering()
            figure.set_layout_engine("none")
            for kind in KINDS:
                contents[f"{name}.{kind}"] = _bytes(figure, kind)
    return contents


def draw_water(findings: Findings, name: str, number: int) -> Figure:
    """Draw figure 1, 2 or 3: power and signal-to-noise ratio against depth in one water."""
    from matplotlib.figure import Figure

    light, receiver = findings.lights[name], findings.isolated.receiver
    found = curves(light, receiver, illumination=ISOLATED)
    flooded = curves(light, receiver, illumination=FLOOD)
    figure = Figure(figsize=(12.0, 5.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    water = light.water
    figure.suptitle(
        f"Figure {number}: {name}, {WATER_WORDS[name]}, a = {water.absorption:g}, "
        f"b = {water.scattering:g}, c = {water.attenuation:.3f} 1/m",
        fontsize=12,
    )
    _power_panel(left, found, flooded)
    _mark_levels(left, receiver)
    _snr_panel(right, found)
    _mark_depths(right, findings.isolated, name)
    for axes in (left, right):
        axes.set_xlim(-2.0, SHOWN_TO)
        axes.set_xlabel("depth h, half of the path in the water [m]")
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


def _power_panel(axes: Axes, found: Curves, flooded: Curves) -> None:
    drawn = (
        (flooded, NEIGHBOURS, 1.2, "flood: with light from the neighbours' footprints"),
        (found, COLUMN, 1.8, "isolated pixel"),
    )
    for curve, colour, width, words in drawn:
        settled = _settled(curve.power, curve.power_error)
        axes.plot(curve.depth, settled, color=colour, lw=width, label=words)
        error = 1.96 * curve.power_error
        low, high = np.maximum(settled - error, 0.1 * settled), settled + error
        axes.fill_between(curve.depth, low, high, color=colour, alpha=0.25, lw=0.0)
    at_bottom = found.depth.searchsorted(instrument.BOTTOM_DEPTH)
    if found.power[at_bottom] < POWER_RANGE[0]:
        axes.text(
            instrument.BOTTOM_DEPTH, 2.0 * POWER_RANGE[0], "bottom: far\nbelow this scale",
            ha="center", fontsize=8, color=COLUMN,
        )  # fmt: skip
    axes.set_yscale("log")
    axes.set_ylim(*POWER_RANGE)
    axes.set_ylabel("received power P(h) [W]")
    axes.set_title("(a) surface, water column, bottom at 50 m", loc="left", fontsize=10)
    axes.legend(loc="upper right", fontsize=8, frameon=False)


def _mark_levels(axes: Axes, receiver: PaperReceiver) -> None:
    """Draw the power of the sun and of a photo-electron in the measuring time."""
    per_watt = float(receiver.signal_rate(np.array(1.0))) / receiver.aperture_area
    levels = (
        (
            receiver.background_rate(instrument.SUNS["day"]),
            "by day: $L_b$ = 50 W/(m² µm sr)",
            True,
            True,
        ),
        (
            receiver.background_rate(instrument.SUNS["night"]),
            "by night: $L_b$ = 0.001 W/(m² µm sr)",
            False,
            False,
        ),
        (1.0 / instrument.MEASURING_TIME, "1 photo-electron in 10 ns", False, True),
    )
    for rate, words, to_right, above in levels:
        level = rate / per_watt
        axes.axhline(level, color=LEVEL, ls=":", lw=1.0)
        axes.text(
            SHOWN_TO if to_right else -1.5, level * (1.25 if above else 0.8), words, color=LEVEL,
            ha="right" if to_right else "left", va="bottom" if above else "top", fontsize=8,
        )  # fmt: skip


def _snr_panel(axes: Axes, found: Curves) -> None:
    for colour, (brightness, snr) in zip(COLOURS, found.snr.items(), strict=True):
        settled = _settled(snr, found.snr_error[brightness])
        axes.plot(found.depth, settled, color=colour, lw=1.4, label=f"{brightness:g}")
    axes.axhline(instrument.REQUIRED_SNR, color=LEVEL, ls="--", lw=1.0)
    axes.text(
        -1.5, 0.7 * instrument.REQUIRED_SNR, "required: 10", color=LEVEL, va="top", fontsize=8
    )
    axes.set_yscale("log")
    axes.set_ylim(*SNR_RANGE)
    axes.set_ylabel("signal-to-noise ratio, eq. (10), of powers [1]")
    axes.set_title("(b) isolated pixel, by brightness of the sun", loc="left", fontsize=10)
    axes.legend(
        title="$L_b$ [W/(m² µm sr)]", loc="upper right", fontsize=8, title_fontsize=8, frameon=False
    )


def _mark_depths(axes: Axes, found: Fit, water: str) -> None:
    """Mark where the ratio falls to 10, in the paper and here."""
    level = instrument.REQUIRED_SNR
    axes.text(0.985, 0.63, "falls to 10 at:", transform=axes.transAxes, ha="right", fontsize=9)
    for place, (sun, colour) in enumerate((("night", COLOURS[0]), ("day", COLOURS[-1]))):
        published, here = instrument.PUBLISHED[sun][water], found.depths[sun][water]
        axes.plot(published, level, "v", mfc="white", mec=colour, ms=8, zorder=4)
        axes.plot(here, level, "o", color=colour, ms=6, zorder=5)
        axes.text(
            0.985, 0.58 - 0.05 * place, f"{sun}: paper ▽ {published:g} m, here ● {here:.1f} m",
            transform=axes.transAxes, ha="right", fontsize=9, color=colour,
        )  # fmt: skip


def _settled(value: FloatArray, error: FloatArray) -> FloatArray:
    """Return the curve to where its standard error first grows too large to draw it."""
    unsettled = ~((value > 0.0) & (error < SETTLED * value))
    return np.where(np.logical_or.accumulate(unsettled), np.nan, value)


def _bytes(figure: Figure, kind: str) -> bytes:
    content = io.BytesIO()
    metadata = {"Software": None} if kind == "png" else {"Date": None}
    figure.savefig(content, format=kind, dpi=DOTS_PER_INCH, metadata=metadata)
    return content.getvalue()
