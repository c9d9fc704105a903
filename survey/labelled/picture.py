"""The waveform of one pixel as a picture: by origin, with thresholds, echoes and truth."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.constants import speed_of_light

from survey.cloud.noise import gate_sums
from survey.cloud.points import Outcome
from survey.products.report.curves import GREY, ORIGINS
from survey.products.writing import write_whole

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (11.0, 8.0)
DOTS_PER_INCH = 130
NANO = 1e-9
LEAST_SHOWN = 1e-3  # of the strongest light of the background's bin
COLOURS = ORIGINS | {"background": GREY}
COUNTS = "#303030"


def draw(path: Path, pixel: xarray.Dataset) -> None:
    """Write the picture, PNG or SVG by the suffix.

    Parameters
    ----------
    path : Path
    pixel : xarray.Dataset
        One pixel, from `survey.labelled.picked.PickedPixels`.
    """
    figure = waveform_figure(pixel, size=SIZE)
    content = io.BytesIO()
    metadata = {"Software": None} if path.suffix.lower() == ".png" else {"Date": None}
    figure.savefig(content, format=path.suffix[1:].lower(), dpi=DOTS_PER_INCH, metadata=metadata)
    write_whole(path, content.getvalue())


def waveform_figure(pixel: xarray.Dataset, *, size: tuple[float, float]) -> Figure:
    """Return the waveform of one pixel, above light by origin and below what its gates hold.

    Parameters
    ----------
    pixel : xarray.Dataset
        From `survey.labelled.picked.PickedPixels`.
    size : (width, height)
        In inches.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    light, gates = figure.subplots(2, 1, sharex=True)
    figure.suptitle(
        f"{pixel.title}: frame {int(pixel.frame)}, row {int(pixel.row)}, "
        f"column {int(pixel.column)}; simulated",
        x=0.01,
        ha="left",
    )
    _light(light, pixel)
    _gates(gates, pixel)
    for axes in (light, gates):
        _times(axes, pixel)
        axes.grid(alpha=0.25)
        axes.legend(loc="upper right", fontsize="small")
    _depth_axis(light, pixel)
    return figure


def _light(axes: Axes, pixel: xarray.Dataset) -> None:
    """Draw expected light by origin with its Monte Carlo error, and the readings."""
    time, pulses = pixel.bin_time.values / NANO, pixel.attrs["pulses_per_frame"]
    axes.stairs(pixel.counts.values, _edges(time), color=COUNTS, lw=0.8, label="simulated counts")
    for origin in ("surface", "column", "bottom"):
        mean = pixel[f"expected_{origin}"].values * pulses
        axes.plot(time, mean, color=COLOURS[origin], lw=1.6, label=f"expected, {origin}")
        error = pixel.get(f"expected_{origin}_standard_error")
        if error is not None:
            low, high = mean - error.values * pulses, mean + error.values * pulses
            axes.fill_between(time, low, high, color=COLOURS[origin], alpha=0.3, lw=0.0)
    background = float(pixel.expected_background) * pulses
    axes.axhline(
        background, color=COLOURS["background"], lw=1.2, ls="--", label="expected, background"
    )
    axes.set_yscale("log")
    axes.set_ylim(bottom=max(min(background, 0.5) / 3.0, LEAST_SHOWN))
    axes.set_ylabel("counts or photo-electrons in a bin")
    words = Outcome(int(pixel.outcome)).name.lower().replace("_", " ")
    axes.set_title(
        f"Light by origin, band: Monte Carlo standard error; outcome: {words}",
        loc="left",
        fontsize="medium",
    )


def _gates(axes: Axes, pixel: xarray.Dataset) -> None:
    """Draw the counts of the sliding gate, and what it must hold."""
    time, width = pixel.bin_time.values / NANO, pixel.attrs["gate_bins"]
    sums = gate_sums(pixel.counts.values, width)
    axes.plot(time, sums, color=COUNTS, lw=0.9, label=f"counts of {width} bins")
    for name in ("surface", "bottom"):
        axes.plot(
            time,
            pixel[f"{name}_threshold"],
            color=COLOURS[name],
            lw=1.2,
            ls="--",
            label=f"threshold, {name}",
        )
    axes.set_yscale("log")
    axes.set_ylim(bottom=0.7)
    axes.set_xlabel("time after emission [ns]")
    axes.set_ylabel("counts in a gate")
    axes.set_title("What the gates hold, and must hold", loc="left", fontsize="medium")


def _times(axes: Axes, pixel: xarray.Dataset) -> None:
    for name in ("surface", "bottom"):
        true = float(pixel[f"true_{name}_time"]) / NANO
        found = float(pixel[f"detected_{name}_time"]) / NANO
        colour = COLOURS[name]
        if np.isfinite(true):
            axes.axvline(true, color=colour, lw=1.0, ls=":", label=f"true {name}")
        if np.isfinite(found):
            axes.axvline(found, color=colour, lw=1.0, label=f"{name} as ranged")


def _depth_axis(axes: Axes, pixel: xarray.Dataset) -> None:
    """Add the depth that a time stands for along the true ray, on top."""
    start, path = float(pixel.true_surface_time), float(pixel.water_path)
    if not path > 0.0:
        return
    slant = float(pixel.surface_up - pixel.up) / path
    speed = 0.5 * speed_of_light / pixel.attrs["group_index"] * slant * NANO

    axis = axes.secondary_xaxis(
        "top",
        functions=(
            lambda time: (np.asarray(time) - start / NANO) * speed,
            lambda depth: np.asarray(depth) / speed + start / NANO,
        ),
    )
    axis.set_xlabel("depth under the true surface along the ray [m]")


def _edges(centres: np.ndarray) -> np.ndarray:
    step = centres[1] - centres[0] if len(centres) > 1 else 1.0
    return np.append(centres - 0.5 * step, centres[-1] + 0.5 * step)
