"""One flash as an xarray data set: light by origin, readings, thresholds, echoes and truth.

The dimensions are frame, row, column and bin, also of a sample of pixels: neighbours in space and
time stay neighbours, as convolutions need them, and a table of single waveforms is one
``stack(pixel=("frame", "row", "column"))`` away, while the way back would need an index.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.flight.pose import Frame, Pose
from survey.labelled.attributes import mission_attributes
from survey.labelled.pixels import Pixels
from survey.labelled.variables import VARIABLES, flags
from survey.mission import observe
from survey.preparation import Mission
from survey.products.observation import Observation
from survey.sensor.detector import TimeTags
from survey.sensor.spad import Spad
from terrain.substrate import UNLABELLED

if TYPE_CHECKING:
    import xarray

FloatArray = NDArray[np.float64]
Values = dict[str, Any]

LARGEST_SMALL_COUNT = np.iinfo(np.uint16).max


def labelled_waveforms(
    mission: Mission, frame: Frame, *, pixels: Pixels | None = None
) -> xarray.Dataset:
    """Fly one flash and return what learning needs of it, labelled.

    Parameters
    ----------
    mission : Mission
        From `survey.preparation.prepare`.
    frame : Frame
        One of its frames.
    pixels : Pixels, optional
        Without it, all.

    Returns
    -------
    xarray.Dataset
        Of dimensions frame (1), row, column and bin; `survey.labelled.variables` lists the
        variables. Time tags, dimension tag, are there where the detector tells them.

    Examples
    --------
    >>> from survey import load_scenario, prepare
    >>> mission = prepare(load_scenario("sandbar", {
    ...     "camera.rows": 2, "camera.columns": 4, "transport.walks_per_pixel": 16,
    ...     "transport.tracks_per_replicate": 64}))
    >>> found = labelled_waveforms(mission, mission.frames[0])
    >>> found.counts.dims, found.counts.shape[:3]
    (('frame', 'row', 'column', 'bin'), (1, 2, 4))
    >>> found.bin_time.units, found.expected_bottom.long_name
    ('s', 'expected photo-electrons of bottom and land in one bin of one pulse')
    """
    mission = with_tags(mission)
    return dataset_of(mission, observe(mission, frame), pixels)


def with_tags(mission: Mission) -> Mission:
    """Return the mission with a detector that tells its counts one by one, if it can."""
    if not isinstance(mission.detector, Spad):
        return mission
    return replace(mission, detector=replace(mission.detector, keep_tags=True))


def dataset_of(mission: Mission, seen: Observation, pixels: Pixels | None = None) -> xarray.Dataset:
    """Return what was observed as a data set."""
    import xarray

    chosen = Pixels.every(1, mission.camera.shape) if pixels is None else pixels
    values = (
        _coordinates(mission, seen, chosen)
        | _light(seen)
        | _labels(seen)
        | _pose("sensor", seen.frame.pose, mission)
        | _pose("navigation", seen.frame.measured, mission)
        | _water(mission)
    )
    values = {name: _taken(name, value, chosen) for name, value in values.items()}
    if seen.readings.tags is not None:
        values |= _tags(seen.readings.tags, chosen)
    found = xarray.Dataset(
        {name: _variable(name, value, mission) for name, value in values.items()},
        attrs=mission_attributes(mission),
    )
    found["crs"] = ((), np.int32(0), _crs(mission))
    return found.set_coords(["bin_time", "frame_time", "easting", "northing", "up"])


def _taken(name: str, value: Any, pixels: Pixels) -> NDArray[Any]:
    """Return the chosen pixels of (rows, columns, ...), with a dimension for the frame."""
    dims = VARIABLES[name].dims
    if dims[:3] == ("frame", "row", "column"):
        return np.asarray(value)[pixels.index][None]
    return np.atleast_1d(value)


def _variable(
    name: str, value: NDArray[Any], mission: Mission
) -> tuple[tuple[str, ...], NDArray[Any], Mapping[str, Any]]:
    variable, dtype = VARIABLES[name], VARIABLES[name].dtype
    attributes = variable.attributes
    if name == "frame_time":
        return variable.dims, value, attributes
    if name == "counts":
        dtype = counts_dtype(mission, value.dtype)
    if name == "substrate":
        names = {UNLABELLED: "unlabelled", **mission.seabed.substrate_names}
        attributes |= flags(dict(sorted(names.items())))
    return variable.dims, value.astype(dtype), attributes


def counts_dtype(mission: Mission, read: np.dtype[Any]) -> str:
    """Return the smallest type that holds all readings of a detector: u2, i4, or f4 of a current.

    Every frame of a mission has the same one.
    """
    if read.kind == "f":
        return "f4"
    most = getattr(mission.detector, "max_counts_per_bin", LARGEST_SMALL_COUNT + 1)
    return "u2" if most <= LARGEST_SMALL_COUNT else "i4"


def _coordinates(mission: Mission, seen: Observation, pixels: Pixels) -> Values:
    start = mission.products.start_utc.astimezone(UTC).replace(tzinfo=None)
    since = np.timedelta64(round(seen.frame.time * 1e9), "ns")
    return {
        "frame": seen.frame.index,
        "row": list(pixels.rows),
        "column": list(pixels.columns),
        "bin_time": seen.waveforms.times,
        "frame_time": np.datetime64(start, "ns") + since,
        **_on_map("", seen.targets.position, mission),
        **_on_map("surface_", seen.targets.surface, mission),
    }


def _on_map(prefix: str, local: FloatArray, mission: Mission) -> Values:
    place = mission.seabed.map_frame.to_map(local)
    return {
        f"{prefix}{axis}": place[..., i] for i, axis in enumerate(("easting", "northing", "up"))
    }


def _light(seen: Observation) -> Values:
    light = seen.waveforms
    noise = seen.noise.of_flash(light.variance[:2].sum(axis=0))
    return {
        **{f"expected_{name}": light.origin(name) for name in ("surface", "column", "bottom")},
        "expected_background": noise.steady_light,
        "expected_column_standard_error": np.sqrt(light.variance[1]),
        "expected_bottom_standard_error": np.sqrt(light.variance[2]),
        "counts": seen.readings.counts,
        "surface_threshold": noise.surface_threshold,
        "bottom_threshold": noise.bottom_threshold,
    }


def _labels(seen: Observation) -> Values:
    targets, record, bottom = seen.targets, seen.result.record, seen.result.bottom
    shape = targets.depth.shape
    in_air = np.linalg.norm(targets.surface - seen.frame.pose.position, axis=-1)
    normal = dict(zip(("east", "north", "up"), bottom.true_normal.T, strict=True))
    return {
        "detected_surface_time": seen.first.time,
        "detected_bottom_time": seen.bottom.time,
        "classification": bottom.classification.reshape(shape),
        "outcome": record.outcome,
        "detection_probability": record.detection_probability,
        "tvu": bottom.tvu.reshape(shape),
        "thu": bottom.thu.reshape(shape),
        "true_surface_time": 2.0 * in_air / speed_of_light,
        "true_bottom_time": targets.time,
        "true_depth": targets.depth,
        "water_path": np.linalg.norm(targets.position - targets.surface, axis=-1),
        "true_classification": targets.classification,
        "substrate": targets.substrate,
        **{f"surface_normal_{axis}": part.reshape(shape) for axis, part in normal.items()},
    }


def _pose(prefix: str, pose: Pose, mission: Mission) -> Values:
    turns = {f"{prefix}_{turn}": getattr(pose, turn) for turn in ("roll", "pitch", "heading")}
    return _on_map(f"{prefix}_", pose.position, mission) | turns


def _water(mission: Mission) -> Values:
    layers = mission.engine.water.layers
    return {
        "layer_top": [layer.top for layer in layers],
        "absorption": [layer.water.absorption for layer in layers],
        "scattering": [layer.water.scattering for layer in layers],
    }


def _tags(tags: TimeTags, pixels: Pixels) -> Values:
    """Return the tags of the chosen pixels, sorted by row, column, pulse and time."""
    kept = np.isin(tags.row, pixels.rows) & np.isin(tags.column, pixels.columns)
    row, column, pulse = tags.row[kept], tags.column[kept], tags.pulse[kept]
    time = tags.time[kept]
    order = np.lexsort((time, pulse, column, row))
    count = np.zeros(pixels.shape, np.int32)
    place = (
        (row - pixels.rows.start) // pixels.rows.step,
        (column - pixels.columns.start) // pixels.columns.step,
    )
    np.add.at(count, place, 1)
    return {"tag_count": count[None], "tag_time": time[order], "tag_pulse": pulse[order]}


def tags_of(found: xarray.Dataset, *, frame: int, row: int, column: int) -> slice:
    """Return where along dimension tag the tags of a pixel lie; places count from 0 in the data.

    Examples
    --------
    >>> import xarray
    >>> count = np.array([[[2, 0], [3, 1]]])
    >>> found = xarray.Dataset({"tag_count": (("frame", "row", "column"), count)})
    >>> tags_of(found, frame=0, row=1, column=0)
    slice(2, 5, None)
    """
    count = found.tag_count
    number = int(np.ravel_multi_index((frame, row, column), count.shape))
    end = int(count.values.ravel()[: number + 1].sum(dtype=np.int64))
    return slice(end - int(count[frame, row, column]), end)


def _crs(mission: Mission) -> dict[str, Any]:
    return {
        "long_name": "coordinate system and vertical datum",
        **mission.seabed.map_frame.crs.to_cf(),
    }
