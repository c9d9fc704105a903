"""How far a point may be off: total vertical and horizontal uncertainty, 95 %.

TVU bounds the measured less the true elevation at the measured place, THU the horizontal distance
of that place from where the light of its echo truly was reflected: somewhere in the pixel's
footprint.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.points import PointClass, PointCloud
from survey.flight.pose import Frame

FloatArray = NDArray[np.float64]

WITHIN_95 = 1.96
MATCHED_ALONE = 8.0 / (3.0 * np.sqrt(3.0))
MATCHED_OVER_NOISE = 3.01
SQUARE_WITHIN_95 = 1.198
"""Radius that holds 95 % of a square of half side 1: area of the circle in it, by quadrature."""


def time_noise(*, counts: FloatArray, snr: FloatArray, pulse_sigma: float) -> FloatArray:
    """Return the standard error of an echo's time by its counting noise [s].

    The crest of counts that are convolved with the pulse, Gaussian of deviation s, errs with
    s^2 8 / (3 sqrt 3) / N for N counts alone, and with 4 sqrt(pi) s^3 b / N^2 over a noise of
    variance b in a unit of time: quotients of the variance of the slope and the squared curvature
    at the crest. In a gate of one full width at half maximum B = b 2.355 s, hence 3.01 s^2 B / N^2.

    Parameters
    ----------
    counts, snr : array
        Of the echo: N, and N over the standard deviation of all counts in the gate [1].
    pulse_sigma : float
        Standard deviation of the pulse as the detector sees it [s].

    Examples
    --------
    >>> float(time_noise(counts=np.array(400.0), snr=np.array(20.0), pulse_sigma=4e-9)) * 1e9
    0.248...
    """
    counts, variance = np.maximum(counts, 1.0), (counts / np.maximum(snr, 0.1)) ** 2
    noise = np.maximum(variance - counts, 0.0)
    weighted = MATCHED_ALONE * counts + MATCHED_OVER_NOISE * noise
    return np.asarray(pulse_sigma * np.sqrt(weighted) / counts)


@dataclass(frozen=True, kw_only=True)
class Budget:
    """What a survey knows of the errors of its points.

    Parameters
    ----------
    pulse_sigma : float
        Standard deviation of the pulse as the detector sees it [s].
    group_index : float
        Of the water [1].
    pixel_tangent : float
        Side of a pixel in the tangent plane [1].
    """

    pulse_sigma: float
    group_index: float
    pixel_tangent: float

    def applied(self, cloud: PointCloud, *, frame: Frame) -> PointCloud:
        """Return the points of a frame with their uncertainties."""
        placed = cloud.classification != PointClass.NO_BOTTOM_FOUND
        to_point = cloud.position - frame.measured.position
        cosine = -to_point[:, 2] / np.linalg.norm(to_point, axis=-1)
        noise = time_noise(
            counts=cloud.counts.astype(np.float64),
            snr=cloud.snr.astype(np.float64),
            pulse_sigma=self.pulse_sigma,
        )
        wet = cloud.depth > 0.0
        along = 0.5 * speed_of_light * noise / np.where(wet, self.group_index, 1.0)
        vertical = WITHIN_95 * along * cosine
        footprint = SQUARE_WITHIN_95 * 0.5 * self.pixel_tangent * -to_point[:, 2]
        return replace(
            cloud,
            tvu=np.where(placed, vertical, np.nan).astype(np.float32),
            thu=np.where(placed, footprint, np.nan).astype(np.float32),
        )
