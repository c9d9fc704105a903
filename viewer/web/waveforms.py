"""Waveforms of marked pixels for the page: their frames are flown again from their addresses."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.points import Outcome, PointClass
from survey.labelled.flown_run import FlownRun
from survey.labelled.picked import PickedPixels
from survey.products.frame_file import read_frame
from survey.progress import Watcher
from survey.run_folder import frame_path
from viewer.attributes import elevation_error
from viewer.web.columns import logarithmic, packed
from viewer.web.marks import Marks, marked_pixels

if TYPE_CHECKING:
    import xarray

NANO = 1e-9
LEAST_LIGHT, LIGHT_STEP = 1e-4, 0.02
ERROR_STEP = 0.2
"""Light below 1e-4 photo-electrons is not written; steps are ratios less 1."""

LIGHT = ("surface", "column", "bottom")
ERRORS = ("column", "bottom")
THRESHOLDS = ("surface", "bottom")


def waveforms(run: FlownRun, *, at_least: int, watch: Watcher) -> dict[str, Any]:
    """Fly some frames again and return the waveforms of pixels in them, as the page's JSON.

    Parameters
    ----------
    run : FlownRun
    at_least : int
        Pixels, where the run has them.
    watch : Watcher
        Told of every frame.

    Raises
    ------
    OtherRunError
        When a frame flown again is not the run's own.
    """
    marks = marked_pixels(run.folder, run.whole, at_least=at_least)
    picked = PickedPixels(run)
    watch.started(len(marks))
    pixels: list[dict[str, Any]] = []
    curves: list[dict[str, NDArray[Any]]] = []
    for mark in marks:
        begun = time.monotonic()
        seen = _chosen(picked.frame(mark.frame), mark)
        pixels += _numbers(run, seen, mark)
        curves.append(_curves(seen))
        watch.frame_done(mark.frame, time.monotonic() - begun)
    whole = {name: np.concatenate([curve[name] for curve in curves]) for name in curves[0]}
    return {
        "pixels": pixels,
        "bins": whole["counts"].shape[1],
        "curves": packed({name: curve.ravel() for name, curve in whole.items()}),
        "light": {"least": LEAST_LIGHT, "ratio": 1.0 + LIGHT_STEP},
        "error": {"least": LEAST_LIGHT, "ratio": 1.0 + ERROR_STEP},
        "gateBins": int(seen.attrs["gate_bins"]),
        "pulses": int(seen.attrs["pulses_per_frame"]),
    }


def _chosen(frame: xarray.Dataset, mark: Marks) -> xarray.Dataset:
    """Return the marked pixels of a frame, along dimension pixel."""
    import xarray

    row, column = (xarray.DataArray(index, dims="pixel") for index in (mark.row, mark.column))
    return frame.isel(frame=0).isel(row=row, column=column)


def _curves(seen: xarray.Dataset) -> dict[str, NDArray[Any]]:
    """Return every curve (pixels, bins) in whole steps."""
    pulses, shape = seen.attrs["pulses_per_frame"], seen.counts.shape

    def light(name: str, step: float) -> NDArray[np.int64]:
        return logarithmic(seen[name].values * pulses, least=LEAST_LIGHT, step=step)

    return {
        "counts": np.round(seen.counts.values).astype(np.int64),
        **{name: light(f"expected_{name}", LIGHT_STEP) for name in LIGHT},
        **{
            f"{name}_error": light(f"expected_{name}_standard_error", ERROR_STEP) for name in ERRORS
        },
        **{
            f"{name}_threshold": np.broadcast_to(
                np.round(np.nan_to_num(seen[f"{name}_threshold"].values, posinf=0.0)), shape
            ).astype(np.int64)
            for name in THRESHOLDS
        },
    }


def _numbers(run: FlownRun, seen: xarray.Dataset, mark: Marks) -> list[dict[str, Any]]:
    """Return what the page says of each pixel; times in ns after emission, lengths in m."""
    kept = read_frame(frame_path(run.folder, mark.frame))
    shape = kept.record.outcome.shape
    of_pixel = np.ravel_multi_index((mark.row, mark.column), shape)
    placed = kept.bottom.classification[of_pixel] != PointClass.NO_BOTTOM_FOUND
    error = np.where(placed, elevation_error(kept.bottom)[of_pixel], np.nan)
    depth = np.where(placed, kept.bottom.depth[of_pixel], np.nan)
    bins = seen.bin_time.values / NANO
    numbers = {
        "x": kept.record.true_position[mark.row, mark.column, 0],
        "y": kept.record.true_position[mark.row, mark.column, 1],
        "z": kept.record.true_position[mark.row, mark.column, 2],
        "trueDepth": seen.true_depth.values,
        "depth": depth,
        "error": error,
        "tvu": np.where(placed, seen.tvu.values, np.nan),
        "probability": seen.detection_probability.values,
        "background": np.full(len(of_pixel), float(seen.expected_background) * _pulses(seen)),
        "metresPerNs": _depth_per_time(seen),
        **{
            f"{kind}{name.capitalize()}": seen[f"{word}_{name}_time"].values / NANO
            for kind, word in (("true", "true"), ("found", "detected"))
            for name in ("surface", "bottom")
        },
    }
    return [
        {
            "frame": mark.frame,
            "row": int(mark.row[place]),
            "column": int(mark.column[place]),
            "outcome": Outcome(int(seen.outcome.values[place])).name.lower().replace("_", " "),
            "firstBin": float(bins[0]),
            "binWidth": float(bins[1] - bins[0]),
            **{name: _plain(values[place]) for name, values in numbers.items()},
        }
        for place in range(len(of_pixel))
    ]


def _pulses(seen: xarray.Dataset) -> float:
    return float(seen.attrs["pulses_per_frame"])


def _depth_per_time(seen: xarray.Dataset) -> NDArray[Any]:
    """Return how much deeper along the true ray an echo is for 1 ns; nan on land."""
    path = seen.water_path.values
    slant = np.divide(
        seen.surface_up.values - seen.up.values,
        path,
        out=np.full(path.shape, np.nan),
        where=path > 0.0,
    )
    return np.asarray(0.5 * speed_of_light / seen.attrs["group_index"] * slant * NANO)


def _plain(value: float) -> float | None:
    """Return a number with six digits as JSON has it, none for nan."""
    return float(f"{value:.6g}") if np.isfinite(value) else None
