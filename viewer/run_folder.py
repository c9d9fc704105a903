"""What a picture needs of a run folder."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass, PointCloud
from survey.products.ply_file import read_ply
from survey.products.trajectory_file import read_trajectory_csv
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class FlownSurvey:
    """A finished run, in the local frame of its clouds.

    Parameters
    ----------
    title, description : str
        Of the mission.
    water_level : float
        In the vertical datum [m].
    bottom, surface : PointCloud
        Stitched clouds.
    positions : array (frames, 3)
        True places of the sensor [m].
    headings : array (frames,)
        True headings [rad].
    frame, line : array (frames,)
        Numbers of the flashes and of their survey lines.
    map_frame : MapFrame
        Where the local frame lies on the map.
    """

    title: str
    description: str
    water_level: float
    bottom: PointCloud
    surface: PointCloud
    positions: FloatArray
    headings: FloatArray
    frame: NDArray[np.intp]
    line: NDArray[np.intp]
    map_frame: MapFrame


def read_run(folder: Path) -> FlownSurvey:
    """Read scenario, clouds and trajectory of a run folder.

    Raises
    ------
    FileNotFoundError
        If one of the four files is missing; the text names the folder and all that is missing.
    ValueError
        If a file is not what bathyflash writes.
    """
    names = ("scenario.toml", "bottom.ply", "water_surface.ply", "trajectory.csv")
    missing = [name for name in names if not (folder / name).is_file()]
    if missing:
        raise FileNotFoundError(
            f"{folder}: no {', no '.join(missing)}. Finish the run with: bathyflash run"
        )
    scenario = _read_scenario(folder / "scenario.toml")
    bottom, map_frame = read_ply(folder / "bottom.ply")
    surface, _ = read_ply(folder / "water_surface.ply")
    trajectory = read_trajectory_csv(folder / "trajectory.csv")
    on_map = [trajectory[f"true_{name}"] for name in ("easting_m", "northing_m", "up_m")]
    return FlownSurvey(
        title=scenario["mission"]["title"],
        description=scenario["mission"].get("description", ""),
        water_level=float(scenario["surface"]["water_level_m"]),
        bottom=bottom,
        surface=surface.select(surface.classification == PointClass.WATER_SURFACE),
        positions=map_frame.to_local(np.stack(on_map, axis=1)),
        headings=np.radians(trajectory["true_heading_deg"]),
        frame=trajectory["frame"].astype(np.intp),
        line=trajectory["line"].astype(np.intp),
        map_frame=map_frame,
    )


def _read_scenario(path: Path) -> dict[str, Any]:
    try:
        scenario = tomllib.loads(path.read_text(encoding="utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as fault:
        raise ValueError(f"{path}: {fault}. Use a run that bathyflash wrote") from None
    for section, key in (("mission", "title"), ("surface", "water_level_m")):
        if key not in scenario.get(section, {}):
            raise ValueError(f"{path}: {section}.{key}: missing. Use a run that bathyflash wrote")
    return scenario
