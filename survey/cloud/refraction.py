"""Where rays are bent on their way to the bottom: at the mean level, or at the waves themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.echo import Echo
from survey.cloud.frame_points import WaterLine
from survey.cloud.time_noise import time_noise
from survey.cloud.wave_statistics import Unknown, WaveStatistics
from survey.flight.pose import Frame

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Refraction:
    """How a survey takes the water's surface.

    Parameters
    ----------
    local : bool
        Whether planes are fitted to the first echoes, or the level is the mean one.
    waves : WaveStatistics
        What is known of the waves.
    refractive_index : float
        Of the water [1].
    """

    local: bool
    waves: WaveStatistics
    refractive_index: float

    def applied(
        self, line: WaterLine, *, first: Echo, frame: Frame, rays: FloatArray, pulse_sigma: float
    ) -> tuple[WaterLine, Unknown]:
        """Return the line with its final paths, and what is unknown of the water there.

        The neighbourhoods are as wide as leaves the slope least unknown, by the waves' spectrum
        and by the counting noise of the frame's own first echoes.
        """
        if not self.local or not line.on_water.any():
            return line, self.waves.unknown()
        late = time_noise(counts=first.counts, snr=first.snr, pulse_sigma=pulse_sigma)
        noise = 0.5 * speed_of_light * float(np.median(late[line.on_water]))
        width = self.waves.best_width(noise=noise)
        bent = line.on_local_waves(
            frame=frame, rays=rays, refractive_index=self.refractive_index, width=width
        )
        return bent, self.waves.unknown(width=width, noise=noise)
