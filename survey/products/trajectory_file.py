"""Where the sensor was at every flash, true and as navigation measured it: CSV."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.flight.pose import Frame, Pose
from survey.products.writing import ProductError, write_whole
from terrain.map_frame import MapFrame

POSE_COLUMNS = ("easting_m", "northing_m", "up_m", "roll_deg", "pitch_deg", "heading_deg")
COLUMNS = (
    *("time_s", "frame", "line"),
    *(f"true_{name}" for name in POSE_COLUMNS),
    *(f"measured_{name}" for name in POSE_COLUMNS),
)


def write_trajectory_csv(
    path: Path, frames: Sequence[Frame], measured: Sequence[Pose], map_frame: MapFrame
) -> None:
    """Write one line a flash: time, frame, line, true pose, measured pose.

    Metres have four decimals, degrees six, seconds nine. Senses are those of `Pose`.

    Parameters
    ----------
    path : Path
        File to write.
    frames : sequence of Frame
        Flashes with their true poses in the local frame.
    measured : sequence of Pose
        What navigation said, one a frame; the true poses where it is taken as perfect.
    map_frame : MapFrame
        Where the local frame lies on the map.

    Raises
    ------
    ProductError
        If there are no frames, or not one measured pose a frame.
    """
    if not frames or len(measured) != len(frames):
        raise ProductError(
            f"{path.name}: {len(frames)} frames and {len(measured)} measured poses. "
            "Give at least one frame, and one measured pose for each"
        )
    rows = [
        ",".join(
            [
                *(f"{frame.time:.9f}", str(frame.index), str(frame.line)),
                *_pose_fields(frame.pose, map_frame),
                *_pose_fields(pose, map_frame),
            ]
        )
        for frame, pose in zip(frames, measured, strict=True)
    ]
    write_whole(path, ("\n".join([",".join(COLUMNS), *rows]) + "\n").encode("ascii"))


def read_trajectory_csv(path: Path) -> dict[str, NDArray[np.float64]]:
    """Return the columns by name, each (frames,), in the units of their names.

    Raises
    ------
    ProductError
        If the file has other columns.
    """
    with path.open(encoding="ascii") as file:
        names = tuple(file.readline().strip().split(","))
        if names != COLUMNS:
            raise ProductError(f"{path}: line 1: not the columns of a bathyflash trajectory")
        table = np.loadtxt(file, delimiter=",", ndmin=2)
    return dict(zip(COLUMNS, table.T, strict=True))


def _pose_fields(pose: Pose, map_frame: MapFrame) -> list[str]:
    place = map_frame.to_map(pose.position)
    angles = np.degrees([pose.roll, pose.pitch, pose.heading])
    return [*(f"{value:.4f}" for value in place), *(f"{value:.6f}" for value in angles)]
