"""Score a cloud: errors, false and missed bottoms, classes, by depth."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.frame_points import CREST_PER_WAVE_HEIGHT
from survey.cloud.truth import FALSE_BOTTOM_ERROR
from survey.products.pixels import DETECTABLE
from survey.scenario import components
from survey.score.faults import ScoreError, gathered
from survey.score.foreign_cloud import BOTTOM, ForeignCloud, read_cloud
from survey.score.scored_run import ScoredRun
from survey.score.truth import NEAR_SURFACE, TRUE_CLASSES, Truth, class_name, truth_at

__all__ = ["BOTTOM", "require_place", "score_cloud"]

FloatArray = NDArray[np.float64]
DEPTH_BIN = 1.0  # [m]
DECIMALS = 6


def require_place(path: Path) -> None:
    """Raise unless a file can be written to a path."""
    if not path.parent.is_dir():
        raise ScoreError([f"{path.parent}: no such folder"], only_missing_files=True)


def score_cloud(path: Path, folder: Path, *, bottom: Sequence[int] = BOTTOM) -> dict[str, Any]:
    """Score a cloud of others against the truth of a run; plain values for JSON.

    ``benchmark`` says by which scenario, seed and code; ``all_depths`` and each of ``by_depth``
    (bins of 1 m of true depth) hold

    ====================  ======================================================================
    points                points that claim to be bottom and have a truth
    bias_m, rmse_m,       mean, root mean square, 95th percentile of the absolute errors, measured
    p95_abs_error_m       less true elevation at the measured place
    false_bottoms         with an absolute error above 1 m
    detectable            pixels over water whose bottom one flash finds nine times in ten
    missed_bottoms        of these, without a bottom point within 1 m in height and a cell beside
    ====================  ======================================================================

    and ``confusion`` counts the points by the class they have and what is truly there.

    Parameters
    ----------
    path : Path
        The cloud.
    folder : Path
        A finished run.
    bottom : sequence of int
        Classes that claim to be bottom.

    Raises
    ------
    ScoreError
        With every fault of run and cloud at once.
    """
    faults: list[str] = []
    run, cloud = None, None
    if not path.is_file():
        faults.append(f"{path}: no such file")
    with gathered(faults):
        run = ScoredRun.open(folder)
    if run is not None and path.is_file():
        with gathered(faults):
            cloud = read_cloud(path, run.map_frame, bottom=bottom)
    if run is None or cloud is None:
        missing = all(fault.endswith(("no such file", "no such folder")) for fault in faults)
        raise ScoreError(faults, only_missing_files=missing)
    return _scored(path, run, cloud)


def _scored(path: Path, run: ScoredRun, cloud: ForeignCloud) -> dict[str, Any]:
    seabed = run.seabed()
    places, depths = _detectable(run)
    _require_same_place(path, run, cloud)
    waves = components.sea_surface(run.scenario).wave_height
    reach = max(NEAR_SURFACE, CREST_PER_WAVE_HEIGHT * waves)
    truth = truth_at(cloud.position, seabed, water_level=run.water_level, reach=reach)
    claimed = cloud.bottom & np.isfinite(truth.error)
    error, depth = truth.error[claimed], truth.depth[claimed]
    right = cloud.position[claimed][np.abs(error) <= FALSE_BOTTOM_ERROR, :2]
    missed = _missed(places, right, reach=run.cell)
    bins = np.unique(np.concatenate([_bin(depth), _bin(depths)])).tolist()
    return {
        "cloud": path.name,
        "benchmark": _benchmark(run),
        "notes": list(cloud.notes),
        "points": len(cloud.position),
        "points_claiming_bottom": int(cloud.bottom.sum()),
        "points_off_the_known_seabed": int((cloud.bottom & np.isnan(truth.error)).sum()),
        "cell_m": run.cell,
        "all_depths": _row(error, missed),
        "by_depth": [
            {"from_depth_m": number * DEPTH_BIN, "to_depth_m": (number + 1) * DEPTH_BIN}
            | _row(error[_bin(depth) == number], missed[_bin(depths) == number])
            for number in bins
        ],
        "confusion": _confusion(cloud, truth),
    }


def _benchmark(run: ScoredRun) -> dict[str, Any]:
    mission = run.scenario.mission
    return {
        "title": mission.title,
        "seed": mission.seed,
        "frames": len(run.frames),
        **run.manifest,
    }


def _bin(depth: FloatArray) -> NDArray[np.intp]:
    """Return the number of each depth's bin; land has -1."""
    return np.maximum(np.floor(depth / DEPTH_BIN), -1.0).astype(np.intp)


def _row(error: FloatArray, missed: NDArray[np.bool_]) -> dict[str, Any]:
    found: dict[str, Any] = dict.fromkeys(("bias_m", "rmse_m", "p95_abs_error_m"))
    if error.size:
        found = {
            "bias_m": round(float(error.mean()), DECIMALS),
            "rmse_m": round(float(np.sqrt(np.mean(error**2))), DECIMALS),
            "p95_abs_error_m": round(float(np.percentile(np.abs(error), 95.0)), DECIMALS),
        }
    return {
        "points": int(error.size),
        **found,
        "false_bottoms": int((np.abs(error) > FALSE_BOTTOM_ERROR).sum()),
        "detectable": int(missed.size),
        "missed_bottoms": int(missed.sum()),
    }


def _detectable(run: ScoredRun) -> tuple[FloatArray, FloatArray]:
    """Return places (n, 2) and true depths (n,) of the pixels that should find a bottom [m]."""
    places, depths = [np.empty((0, 2))], [np.empty(0)]
    for record in run.records():
        which = (record.true_depth > 0.0) & (record.detection_probability >= DETECTABLE)
        which &= np.isfinite(record.true_position).all(axis=-1)
        places.append(record.true_position[which][:, :2])
        depths.append(record.true_depth[which])
    return np.concatenate(places), np.concatenate(depths)


def _missed(places: FloatArray, right: FloatArray, *, reach: float) -> NDArray[np.bool_]:
    """Tell which places have no right bottom point within reach (n,)."""
    from scipy.spatial import cKDTree

    if len(right) == 0 or len(places) == 0:
        return np.ones(len(places), dtype=np.bool_)
    distance, _ = cKDTree(right).query(places, distance_upper_bound=reach)
    return ~np.isfinite(distance)


def _confusion(cloud: ForeignCloud, truth: Truth) -> dict[str, dict[str, int]]:
    table = {}
    for number in np.unique(cloud.classification).tolist():
        counts = np.bincount(
            truth.true_class[cloud.classification == number], minlength=len(TRUE_CLASSES)
        )
        table[class_name(number)] = dict(zip(TRUE_CLASSES, counts.tolist(), strict=True))
    return table


def _require_same_place(path: Path, run: ScoredRun, cloud: ForeignCloud) -> None:
    """Raise when no point that claims to be bottom lies where the run looked."""
    seen = np.concatenate([record.true_position.reshape(-1, 3)[:, :2] for record in run.records()])
    seen = seen[np.isfinite(seen).all(axis=1)]
    low, high = seen.min(axis=0) - run.cell, seen.max(axis=0) + run.cell
    claimed = cloud.position[cloud.bottom][:, :2]
    if ((claimed >= low) & (claimed <= high)).all(axis=1).any():
        return
    origin = run.map_frame.origin[:2]
    middle, theirs = 0.5 * (low + high), np.median(claimed, axis=0)
    swapped = (theirs + origin)[::-1] - origin
    hint = ""
    if ((swapped >= low) & (swapped <= high)).all():
        hint = " its easting and northing are swapped."
    away = float(np.linalg.norm(theirs - middle))
    raise ScoreError(
        [
            f"{path}: another place: no bottom point lies where the run looked, the middle is "
            f"{away:.0f} m away.{hint} give a cloud of this run, in EPSG:{run.map_frame.epsg}"
        ]
    )
