"""Missions flown with and without each effect, and how far their figures are apart.

All are flown with the same random numbers over the same frames, so that their differences scatter
less than the figures do. Standard errors are jackknives over the frames, which are taken as
independent.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import Outcome
from survey.effects.switches import effects
from survey.mission import fly_frames
from survey.preparation import prepare
from survey.products.frame_file import FrameResult
from survey.scenario.scenario import Scenario

FloatArray = NDArray[np.float64]

FIGURES = ("rmse_m", "bias_m", "sideways_m", "lost_percent", "false_percent")
AS_IT_IS = "nothing"


@dataclass(frozen=True, kw_only=True)
class Cost:
    """The figures of a mission without an effect; arrays in the order of `FIGURES`.

    Parameters
    ----------
    without : str
        What is left out.
    value, error : array (5,)
        Of the bottom points within 1 m of the true seabed: root mean square and mean of measured
        less true elevation, root mean square distance on the map from where the pixel's ray truly
        ends [m]; of the wet pixels: without a bottom, with one farther off than 1 m [%]. And their
        standard errors.
    change, change_error : array (5,)
        Those figures less those of the mission as it is, and the standard errors.
    """

    without: str
    value: FloatArray
    error: FloatArray
    change: FloatArray
    change_error: FloatArray


def costs(scenario: Scenario, *, frames: range | None = None, workers: int = 0) -> Iterator[Cost]:
    """Fly a mission as it is and without each of its effects, and yield the figures.

    What scattered light does to the bottom stays uncorrected: else its cost would not show.

    Parameters
    ----------
    scenario : Scenario
    frames : range, optional
        Only these.
    workers : int
        Frames flown at once; 0 is one for each core.

    Raises
    ------
    ValueError
        When a mission cannot be flown.
    """
    scenario = scenario.replace(**{"processing.correct_scattering": False})
    whole = _flown_sums(scenario, frames, workers)
    yield cost(AS_IT_IS, whole, whole)
    for name, changes in effects(scenario).items():
        yield cost(name, _flown_sums(scenario.replace(**changes), frames, workers), whole)


def _flown_sums(scenario: Scenario, frames: range | None, workers: int) -> FloatArray:
    mission = prepare(scenario)
    chosen = mission.frames if frames is None else mission.frames[frames.start : frames.stop]
    flown = {index: result for index, result, _ in fly_frames(mission, chosen, workers)}
    return np.array([frame_sums(flown[frame.index]) for frame in chosen])


def frame_sums(result: FrameResult) -> Sequence[float]:
    """Return wet pixels, those found, found falsely, and sums of the errors of those found.

    These are of the elevation [m], of its square and of the square of the distance on the map [m2].
    """
    record, points = result.record, result.bottom
    outcome = record.outcome.ravel()
    error = points.position[:, 2] - points.true_elevation
    found = (outcome == Outcome.FOUND) & np.isfinite(error)
    away = np.sum((points.position - points.truth)[found, :2] ** 2)
    return (
        float((record.true_depth > 0.0).sum()),
        float(found.sum()),
        float((outcome == Outcome.FALSE_BOTTOM).sum()),
        float(error[found].sum()),
        float((error[found] ** 2).sum()),
        float(away),
    )


def cost(without: str, sums: FloatArray, whole: FloatArray) -> Cost:
    """Return the figures of one mission and how far they are from those of the whole one.

    Parameters
    ----------
    without : str
        What is left out.
    sums, whole : array (frames, 6)
        `frame_sums` of the frames of both.
    """
    value, spread = _jackknifed(figures_of, sums)
    change, change_spread = _jackknifed(
        lambda both: figures_of(both[:, :6]) - figures_of(both[:, 6:]), np.hstack([sums, whole])
    )
    return Cost(
        without=without, value=value, error=spread, change=change, change_error=change_spread
    )


def figures_of(sums: FloatArray) -> FloatArray:
    """Return the `FIGURES` (5,) of the sums (frames, 6) of some frames; nan where nothing is found.

    Examples
    --------
    >>> figures_of(np.array([[10.0, 4.0, 1.0, -0.4, 1.0, 4.0]])).tolist()
    [0.5, -0.1, 1.0, 50.0, 10.0]
    """
    wet, found, false, error, square, away = sums.sum(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.array(
            [
                np.sqrt(square / found),
                error / found,
                np.sqrt(away / found),
                100.0 * (wet - found - false) / wet,
                100.0 * false / wet,
            ]
        )


def _jackknifed(
    statistic: Callable[[FloatArray], FloatArray], sums: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return a statistic of the frames and its standard error; nan of a single frame."""
    count = len(sums)
    whole = statistic(sums)
    if count < 2:
        return whole, np.full_like(whole, np.nan)
    left = np.array([statistic(np.delete(sums, i, axis=0)) for i in range(count)])
    spread = np.sum((left - left.mean(axis=0)) ** 2, axis=0)
    return whole, np.sqrt((count - 1) / count * spread)
