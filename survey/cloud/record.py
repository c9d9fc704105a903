"""Truth and outcome of every pixel of one frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from survey.cloud.bottom_search import BottomSearch
from survey.cloud.georeference import depth_of
from survey.cloud.noise import NoiseModel, gate_sums
from survey.cloud.points import BOTTOM_CLASSES, NOISE_CLASSES, PixelRecord, PointCloud
from survey.cloud.ranging import GUARD_GATES
from survey.cloud.truth import TrueTargets, outcomes
from survey.cloud.weak_echoes import weak_causes
from survey.optics.water import WaterColumn
from survey.transport.waveforms import Waveforms

FloatArray = NDArray[np.float64]


def pixel_record(
    *,
    waveforms: Waveforms,
    saturated: NDArray[np.bool_],
    points: PointCloud,
    targets: TrueTargets,
    noise: NoiseModel,
    search: BottomSearch,
    water: WaterColumn,
) -> PixelRecord:
    """Return what each pixel could have seen, and what became of it.

    Parameters
    ----------
    waveforms : Waveforms
        Expected photo-electrons, the bottom's among them.
    saturated : array (rows, columns)
        Pixels that were blind when the bottom's light came.
    points : PointCloud
        The frame's bottom points, one a pixel in the order of rows and columns.
    targets : TrueTargets
        Where the pixels truly look.
    noise : NoiseModel
        Its gates.
    search : BottomSearch
        How the bottom was looked for.
    water : WaterColumn
        The true one.
    """
    expected = waveforms.origin("bottom")
    probability = search.probability(expected)
    counts, spread = _best_gate(
        expected, np.sqrt(waveforms.variance[2], dtype=np.float64), noise.gate_bins
    )
    error = (points.position[:, 2] - points.true_elevation).reshape(probability.shape)
    classes = points.classification.reshape(probability.shape)
    width = noise.bin_width
    outcome = outcomes(
        targets=targets,
        error=error,
        found=np.isin(classes, BOTTOM_CLASSES),
        noise=np.isin(classes, NOISE_CLASSES),
        saturated=saturated,
        probability=probability,
        gate=(noise.bin_start, noise.bin_start + expected.shape[-1] * width),
        shallowest=depth_of(
            time=GUARD_GATES * noise.gate_bins * width, group_index=water.group_index
        ),
    )
    return PixelRecord(
        true_position=targets.position,
        true_depth=targets.depth,
        detection_probability=probability,
        outcome=weak_causes(
            outcome=outcome,
            bottom=expected,
            surface=waveforms.origin("surface"),
            targets=targets,
            water=water,
            search=search,
        ),
        bottom_counts=counts,
        monte_carlo_relative_error=np.divide(
            spread, counts, out=np.zeros_like(counts), where=counts > 0.0
        ),
    )


def _best_gate(
    expected: FloatArray, error: FloatArray, gate_bins: int
) -> tuple[FloatArray, FloatArray]:
    """Return counts and their error in each pixel's strongest gate.

    The pulse makes the errors of neighbouring bins rise and fall together, so they are summed.
    """
    sums = gate_sums(expected, gate_bins)
    best = sums.argmax(axis=-1)[..., None]
    return (
        np.take_along_axis(sums, best, -1)[..., 0],
        np.take_along_axis(gate_sums(error, gate_bins), best, -1)[..., 0],
    )
