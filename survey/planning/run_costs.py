"""What a run will cost in time and on disk, and how sure its column is, by measured figures."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from math import sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.optics.response_table import Illumination
from survey.optics.water import WaterColumn
from survey.optics.water_response import named_depth, named_shares

FloatArray = NDArray[np.float64]

STARTUP = 5.0  # imports, seabed, folder; not the compiling on the very first run [s]


@dataclass(frozen=True, kw_only=True)
class RunSize:
    """What makes a run large.

    Parameters
    ----------
    frames, pixels, bins : int
        Frames of the mission, pixels of a frame, bins of a pixel.
    walks_per_pixel : int
        Of the Monte Carlo.
    scattering_depth : float
        b z of the median bottom [1].
    model_frames : int
        Flashes in turn that a run spends on what it expects of its water.
    area : float
        Of the ground that is seen [m2].
    grid : float
        Side of the cells of its rasters [m].
    waveform_step : int, optional
        Every how many rows and columns waveforms are kept; None where they are not.
    """

    frames: int
    pixels: int
    bins: int
    walks_per_pixel: int
    scattering_depth: float
    model_frames: int
    area: float
    grid: float
    waveform_step: int | None


def machine() -> str:
    """Return on what the figures were measured."""
    return str(_measured()["machine"])


def frame_seconds(size: RunSize) -> float:
    """Return the seconds that one worker takes for one frame [s]."""
    rows = _measured()["frames"]
    per_walk = _measured()["walks_per_pixel"] * np.array([row["pixels"] for row in rows])
    line = np.polynomial.Polynomial.fit(
        [row["scattering_depth"] for row in rows], [row["seconds"] for row in rows] / per_walk, 1
    )
    return float(line(size.scattering_depth)) * size.pixels * size.walks_per_pixel


def run_seconds(size: RunSize, *, workers: int) -> float:
    """Return how long a run takes [s]: what it expects of the water, its frames, its products.

    Parameters
    ----------
    size : RunSize
    workers : int
        Frames flown at once, each on a core like those measured.
    """
    frame = frame_seconds(size)
    each = float(_measured()["products_s_per_pixel"])
    products = float(_measured()["products_s"]) + each * size.frames * size.pixels
    rounds = -(-size.frames // max(workers, 1))
    return STARTUP + size.model_frames * frame + rounds * frame + products


def output_bytes(size: RunSize) -> float:
    """Return the size of a run's folder [bytes]."""
    each = _measured()["bytes"]
    pixels = size.frames * size.pixels
    step = size.waveform_step
    kept = 0.0 if step is None else pixels * size.bins / step**2
    return float(
        pixels * (each["frame_per_pixel"] + each["clouds_per_pixel"])
        + kept * each["raw_per_pixel_and_bin"]
        + size.area / size.grid**2 * each["rasters_per_cell"]
    )


def column_error(
    water: WaterColumn, illumination: Illumination, depth: FloatArray, *, walks_per_pixel: int
) -> FloatArray:
    """Return the relative Monte Carlo error of the column in one flash and pixel [1].

    Of the named water nearest to that above each depth by b / a, at the same K_d z; it falls with
    the root of the walks.

    Parameters
    ----------
    water : WaterColumn
    illumination : {"flood", "isolated"}
    depth : array (n,)
        [m].
    walks_per_pixel : int

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> coastal = WaterColumn.uniform(
    ...     petzold_water("coastal", refractive_index=1.34, group_index=1.36))
    >>> few, many = (float(column_error(coastal, "flood", np.array([10.0]), walks_per_pixel=n)[0])
    ...              for n in (64, 256))
    >>> 0.05 < few < 0.2, round(few / many, 3)
    (True, 2.0)
    """
    shares = named_shares(water, depth)
    errors = []
    for name in shares:
        found = _measured()["column_error"][name]
        alike = named_depth(water, depth, name)
        errors.append(np.interp(alike, found["depth_m"], found[illumination]))
    nearest = np.argmax(list(shares.values()), axis=0)
    error = np.take_along_axis(np.array(errors), nearest[None], axis=0)[0]
    return np.asarray(error * sqrt(_measured()["walks_per_pixel"] / walks_per_pixel))


@cache
def _measured() -> Mapping[str, Any]:
    source = resources.files("survey.planning") / "data" / "run_costs.json"
    found: dict[str, Any] = json.loads(source.read_text(encoding="utf-8"))
    return found
