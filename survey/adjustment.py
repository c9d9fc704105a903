"""A flown run with its strips brought together, as a second set of products."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.adjustment_truth import true_mounting, true_offsets
from survey.alone import alone
from survey.cloud.points import BOTTOM_CLASSES, PointCloud
from survey.cloud.sights import moved
from survey.cloud.strip_adjustment import LARGEST_ERROR, Adjustment, AdjustmentError, adjust
from survey.cloud.strip_unknowns import Mode
from survey.cloud.strips import strips_of
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.errors import UserError
from survey.flight.navigation import Mounting, Navigation
from survey.flight.pose import Frame
from survey.preparation import product_settings
from survey.products.frame_file import FrameResult
from survey.products.json_file import write_json
from survey.products.run_products import write_products
from survey.products.strip_differences import DIFFERENCES
from survey.products.strip_picture import write_strip_picture
from survey.run_folder import RunFolder
from survey.run_identity import SCENARIO
from survey.scenario import components
from survey.scenario.load import load_scenario

if TYPE_CHECKING:
    from survey.optics.water import WaterColumn
    from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]

REPORT, PICTURE = "adjustment.json", "strip_differences.png"


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """Bottom points within 1 m of the true elevation: root mean squares of their errors [m].

    Parameters
    ----------
    points : int
    horizontal : float
        From the place that the pixel truly looks at.
    elevation : float
        Against the true elevation at the measured place.
    """

    points: int
    horizontal: float
    elevation: float


@dataclass(frozen=True, kw_only=True)
class AdjustedRun:
    """What was solved, and what it did.

    Parameters
    ----------
    adjustment : Adjustment
    mounting : Mounting
        True error of the mounting that was believed.
    offsets : array (lines, 3)
        True offsets of the lines, to be added [m].
    before, after : Accuracy
        Against truth.
    overlaps_before, overlaps_after : list
        Of `overlap_metrics`.
    """

    adjustment: Adjustment
    mounting: Mounting
    offsets: FloatArray
    before: Accuracy
    after: Accuracy
    overlaps_before: list[dict[str, Any]]
    overlaps_after: list[dict[str, Any]]


def adjust_run(
    run: Path, output: Path, *, mode: Mode, largest_error: float = LARGEST_ERROR
) -> AdjustedRun:
    """Solve for boresight or offsets of a run and write its products anew, elsewhere.

    The run itself stays as it is.

    Parameters
    ----------
    run : Path
        Folder of a flown run.
    output : Path
        Folder for the adjusted products: new, empty, or of an earlier adjustment.
    mode : {"boresight", "offsets"}
        One mounting for the survey and an offset for each line, or offsets alone.
    largest_error : float
        Standard error above which a direction is not corrected [m].

    Raises
    ------
    FileNotFoundError
        When there is no run.
    UserError
        When the output holds something else, or the strips cannot be adjusted.
    """
    _require_place(output, run)
    folder = RunFolder.flown(run)
    before = _overlaps_of(run)
    scenario = load_scenario(run / SCENARIO)
    frames = {f.index: f for f in components.frames(scenario) if f.index in folder.whole}
    water, navigation = components.water(scenario), components.navigation(scenario)
    settings, seabed = product_settings(scenario), components.seabed(scenario)
    line_deviations, frame_deviations = _deviations(navigation, scenario.flight.height_m)
    try:
        found = alone(
            adjust,
            strips_of(
                (folder.frame(index).bottom for index in sorted(frames)),
                frames,
                cell_size=settings.pixel_spacing,
                refractive_index=water.refractive_index,
                group_index=water.group_index,
            ),
            mode=mode,
            cell_size=settings.pixel_spacing,
            line_deviations=line_deviations,
            frame_deviations=frame_deviations,
            largest_error=largest_error,
        )
    except AdjustmentError as fault:
        raise UserError(f"{run}: {fault}") from None

    def adjusted(index: int) -> FrameResult:
        return _adjusted(folder.frame(index), found, frames, seabed, water)

    output.mkdir(parents=True, exist_ok=True)
    metrics = write_products(
        output,
        read=adjusted,
        frames=list(frames.values()),
        seabed=seabed,
        settings=replace(
            settings, title=f"{settings.title}, strips adjusted", strip_adjustment=mode
        ),
    )
    write_strip_picture(output / PICTURE, run / DIFFERENCES, output / DIFFERENCES)
    return AdjustedRun(
        adjustment=found,
        mounting=true_mounting(navigation),
        offsets=true_offsets(found, list(frames.values())),
        before=_accuracy(folder.frame(index).bottom for index in frames),
        after=_accuracy(adjusted(index).bottom for index in frames),
        overlaps_before=before,
        overlaps_after=metrics["overlaps"],
    )


def _overlaps_of(run: Path) -> list[dict[str, Any]]:
    """Return the overlaps of a run whose products are written."""
    file = run / "metrics.json"
    found = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
    if "overlaps" not in found or not (run / DIFFERENCES).exists():
        raise UserError(f"{run}: no products yet. Finish it with `bathyflash run`")
    return list(found["overlaps"])


def _require_place(output: Path, run: Path) -> None:
    if output.exists() and not output.is_dir():
        raise UserError(f"{output}: a file. Choose a folder with -o")
    if output.resolve() == run.resolve():
        raise UserError(f"{output}: the run itself, which stays as it is. Choose another folder")
    if output.exists() and any(output.iterdir()) and not (output / REPORT).exists():
        raise UserError(f"{output}: holds files but no adjustment. Choose another folder with -o")


def _deviations(navigation: Navigation, height: float) -> tuple[FloatArray, FloatArray]:
    """Return what navigation says it errs: of a line and of a frame, east, north, up [m].

    Drifts are taken as constant over a line. Roll and pitch move what is a height below.
    """
    tilt = max(navigation.roll.drift, navigation.pitch.drift) * height
    shake = max(navigation.roll.white, navigation.pitch.white) * height
    places = (navigation.east, navigation.north, navigation.up)
    line = np.array([place.drift for place in places])
    frame = np.array([place.white for place in places])
    return np.hypot(line, [tilt, tilt, 0.0]), np.hypot(frame, [shake, shake, 0.0])


def _adjusted(
    result: FrameResult,
    found: Adjustment,
    frames: Mapping[int, Frame],
    seabed: Seabed,
    water: WaterColumn,
) -> FrameResult:
    """Return a frame whose points, and candidates for points, are placed anew."""

    def bottoms(cloud: PointCloud) -> PointCloud:
        here = _moved(cloud, found, frames, water)
        return replace(here, true_elevation=seabed.elevation_at(*here.position[:, :2].T))

    weak = result.candidates
    return replace(
        result,
        bottom=bottoms(result.bottom),
        surface=_moved(result.surface, found, frames, water),
        candidates=None if weak is None else bottoms(weak),
    )


def _moved(
    cloud: PointCloud, found: Adjustment, frames: Mapping[int, Frame], water: WaterColumn
) -> PointCloud:
    lines = found.unknowns.lines
    offsets = {line: found.offset(line) for line in lines}
    shift = np.array([offsets.get(line, np.zeros(3)) for line in cloud.line.tolist()])
    return moved(
        cloud,
        frames,
        mounting=found.mounting,
        shift=shift.reshape(-1, 3),
        refractive_index=water.refractive_index,
        group_index=water.group_index,
    )


def _accuracy(clouds: Iterable[PointCloud]) -> Accuracy:
    sums = np.zeros(3)
    for cloud in clouds:
        error = cloud.position - cloud.truth
        up = cloud.position[:, 2] - cloud.true_elevation
        good = np.isin(cloud.classification, BOTTOM_CLASSES) & np.isfinite(error).all(axis=1)
        good &= np.abs(up) <= FALSE_BOTTOM_ERROR
        sums += [good.sum(), np.sum(error[good, :2] ** 2), np.sum(up[good] ** 2)]
    horizontal, elevation = np.sqrt(sums[1:] / max(sums[0], 1.0))
    return Accuracy(points=int(sums[0]), horizontal=float(horizontal), elevation=float(elevation))


def pooled_rms(found: Sequence[Mapping[str, Any]]) -> float:
    """Return the root mean square difference of all cells of all overlaps [m]."""
    squares = sum(pair["cells"] * pair["rms_difference_m"] ** 2 for pair in found)
    return float(np.sqrt(squares / sum(pair["cells"] for pair in found)))


def write_adjustment(output: Path, values: Mapping[str, Any]) -> None:
    """Write adjustment.json, which also says that a folder is one of adjusted products."""
    write_json(output / REPORT, values)
