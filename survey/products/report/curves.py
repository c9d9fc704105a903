"""Figures of the report that are no maps: depths, errors by depth, detection, a waveform."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.constants import speed_of_light

from survey.products.observation import Observation
from survey.products.report.maps import new_figure, png

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Rows = Sequence[Mapping[str, Any]]
BLUE, ORANGE, GREEN, GREY = "#0072b2", "#d55e00", "#009e73", "#7f7f7f"
ORIGINS = {"surface": BLUE, "column": GREEN, "bottom": ORANGE}
"""Of light, in colours of Okabe and Ito (2008), told apart by the colour-blind."""

COLOURS = (BLUE, ORANGE)
NANO = 1e-9
BEFORE, AFTER = 15.0, 40.0  # the surface and the bottom, in a waveform [ns]


def depth_histogram(rows: Rows) -> bytes:
    """Return how many bottom points lie at which depth."""
    figure, axes = new_figure(height=3.2)
    edges = [row["from_m"] for row in rows]
    axes.bar(edges, [row["points"] for row in rows], width=1.0, align="edge", color=BLUE)
    false = [row["false_bottoms"] for row in rows]
    if any(false):
        axes.bar(edges, false, width=1.0, align="edge", color=ORANGE, label="false bottoms")
        axes.legend(frameon=False)
    axes.set_xlabel("measured depth [m]")
    axes.set_ylabel("bottom points per metre of depth")
    _plain(axes)
    return png(figure)


def error_by_depth(runs: Mapping[str, Rows]) -> bytes:
    """Return the mean error by depth of runs by name, and between which errors 95 % lie."""
    figure, axes = new_figure(height=3.2)
    axes.axhline(0.0, color=GREY, lw=0.8)
    for (name, rows), colour in zip(runs.items(), COLOURS, strict=False):
        told = [row for row in rows if "mean_m" in row]
        depth = [0.5 * (row["from_m"] + row["to_m"]) for row in told]
        mean, low, high = ([row[key] for row in told] for key in ("mean_m", "low_m", "high_m"))
        axes.fill_between(depth, low, high, color=colour, alpha=0.25, lw=0.0)
        axes.plot(depth, mean, color=colour, marker="o", ms=4, label=name)
    axes.set_xlabel("measured depth [m]")
    axes.set_ylabel("measured less true elevation [m]")
    axes.legend(frameon=False)
    _plain(axes)
    return png(figure)


def found_by_strength(runs: Mapping[str, Rows]) -> bytes:
    """Return the share of bottoms found by the expected counts of their echo, of runs by name."""
    figure, axes = new_figure(height=3.2)
    for (name, rows), colour in zip(runs.items(), COLOURS, strict=False):
        counts = [np.sqrt(row["from_counts"] * row["to_counts"]) for row in rows]
        found, expected = (
            [row[f"{key}_fraction"] for row in rows] for key in ("found", "expected")
        )
        axes.plot(counts, found, color=colour, marker="o", ms=4, label=name)
        axes.plot(counts, expected, color=colour, ls="--", label=f"{name}, by the detection model")
    axes.set_xscale("log")
    axes.set_ylim(-0.02, 1.05)
    axes.set_xlabel("expected counts of the bottom's echo")
    axes.set_ylabel("share of wet pixels")
    axes.legend(frameon=False, loc="lower right")
    _plain(axes)
    return png(figure)


def waveform(seen: Observation, *, row: int, column: int) -> bytes:
    """Return one pixel's light by origin, its counts, the threshold, what was found and the truth.

    Light is shown as the counts that it makes on average, all pulses of the frame summed. The
    threshold is that of a gate in the pixel alone; the matched search has others.
    """
    figure, axes = new_figure(height=4.6)
    pixel, noise, light = (row, column), seen.noise, seen.waveforms
    edges = (noise.bin_start + noise.bin_width * np.arange(light.total.shape[-1] + 1)) / NANO
    centres = 0.5 * (edges[1:] + edges[:-1])
    axes.stairs(seen.readings.counts[pixel], edges, color="#303030", lw=0.9, label="counts")
    counted = float(noise.bottomless.sum() / noise.bottomless_light.sum())
    for name, colour in ORIGINS.items():
        expected = counted * light.origin(name)[pixel]
        axes.plot(centres, expected, color=colour, lw=1.6, label=f"expected, {name}")
    axes.plot(
        centres,
        noise.bottom_threshold[pixel] / noise.gate_bins,
        color=GREY,
        ls="--",
        label="plain threshold of a gate, a bin's share",
    )
    times = _drawn_times(axes, seen, pixel)
    axes.set_xlim(times.min() - BEFORE, times.max() + AFTER)
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.05)
    axes.set_xlabel("time after emission [ns]")
    axes.set_ylabel(f"counts in a bin of {noise.bin_width / NANO:g} ns")
    figure.legend(frameon=False, loc="outside upper center", ncols=3, fontsize="small")
    _plain(axes)
    return png(figure)


def _drawn_times(axes: Axes, seen: Observation, pixel: tuple[int, int]) -> np.ndarray:
    """Draw when echoes truly came and when they were found; return these times [ns]."""
    reach = np.linalg.norm(seen.targets.surface[pixel] - seen.frame.pose.position)
    places = (
        ("true surface", 2.0 * reach / speed_of_light, BLUE, ":"),
        ("surface as ranged", seen.first.time[pixel], BLUE, "-"),
        ("true bottom", seen.targets.time[pixel], ORANGE, ":"),
        ("bottom as ranged", seen.bottom.time[pixel], ORANGE, "-"),
    )
    known = [(words, float(time) / NANO, colour, style) for words, time, colour, style in places]
    known = [each for each in known if np.isfinite(each[1])]
    for words, time, colour, style in known:
        axes.axvline(time, color=colour, ls=style, lw=1.1, label=words)
    return np.array([time for _, time, _, _ in known])


def _plain(axes: Axes) -> None:
    axes.grid(alpha=0.25)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
