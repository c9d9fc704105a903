"""What a surface fitted to neighbourhoods leaves unknown of waves whose spectrum is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

WIDTHS = (0.7, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0)
"""Of the neighbourhoods' weights, standard deviations [pixels]."""


@dataclass(frozen=True, kw_only=True)
class Unknown:
    """What is not known of the water where a ray meets it.

    Parameters
    ----------
    height : float
        Standard deviation of its elevation [m].
    slope : float
        Standard deviation of its slope along an axis [1].
    """

    height: float
    slope: float


@dataclass(frozen=True, kw_only=True)
class WaveStatistics:
    """Waves by their spectrum, as log or forecast tell them.

    Parameters
    ----------
    wavenumber : array (n,)
        [rad/m].
    seen : array (n,)
        Share of a wave's amplitude that is left when it is averaged over a pixel [1].
    variance : array (n,)
        Of the elevation, by wave [m2].
    pixel : float
        Side of a pixel on the water [m].
    """

    wavenumber: FloatArray
    seen: FloatArray
    variance: FloatArray
    pixel: float

    @classmethod
    def still(cls, pixel: float) -> WaveStatistics:
        """Return water without waves."""
        none = np.zeros(0)
        return cls(wavenumber=none, seen=none, variance=none, pixel=pixel)

    @classmethod
    def of_elevations(
        cls, elevations: FloatArray, *, spacing: float, pixel: float
    ) -> WaveStatistics:
        """Return the statistics of a patch (n, n) of waves with nodes so far apart [m].

        Its edges are tapered by Hann's window, for swell does not fit into it.
        """
        nodes = elevations.shape[0]
        window = np.hanning(nodes)[:, None] * np.hanning(nodes)
        spectrum = np.abs(np.fft.rfft2((elevations - elevations.mean()) * window)) ** 2
        spectrum[:, 1:-1] *= 2.0
        spectrum *= elevations.var() / spectrum.sum()
        ky = 2.0 * np.pi * np.fft.fftfreq(nodes, spacing)[:, None]
        kx = 2.0 * np.pi * np.fft.rfftfreq(nodes, spacing)
        mean = np.sinc(kx * pixel / 2.0 / np.pi) * np.sinc(ky * pixel / 2.0 / np.pi)
        kept = (spectrum > 1e-9 * spectrum.sum()) & (np.hypot(kx, ky) > 0.0)
        return cls(
            wavenumber=np.hypot(kx, ky)[kept],
            seen=mean[kept],
            variance=spectrum[kept],
            pixel=pixel,
        )

    def unknown(self, *, width: float = np.inf, noise: float = 0.0) -> Unknown:
        """Return what planes through neighbourhoods of a width [pixels] leave unknown.

        A plane weighted by a Gaussian of deviation w sees exp(-k^2 w^2 / 2) of a wave's height and
        slope; what it misses stays unknown. Noise of deviation s in places one pixel p apart adds
        s^2 p^2 / (4 pi w^2) to the variance of the height and s^2 p^2 / (8 pi w^4) to that of each
        slope. Without a width nothing is fitted: the level is the mean one.

        Examples
        --------
        >>> swell = WaveStatistics(wavenumber=np.array([0.1]), seen=np.ones(1),
        ...                        variance=np.array([0.04]), pixel=2.0)
        >>> level, fitted = swell.unknown(), swell.unknown(width=1.0, noise=0.02)
        >>> round(level.height, 3), round(fitted.height, 3), round(level.slope, 4)
        (0.2, 0.007, 0.0141)
        """
        reach = width * self.pixel
        seen = self.seen * np.exp(-0.5 * (self.wavenumber * reach) ** 2)
        left = self.variance * (1.0 - seen) ** 2
        spread = (noise * self.pixel / reach) ** 2 / (4.0 * np.pi)
        return Unknown(
            height=float(np.sqrt(left.sum() + spread)),
            slope=float(np.sqrt(0.5 * (self.wavenumber**2 * left).sum() + 0.5 * spread / reach**2)),
        )

    def best_width(self, *, noise: float) -> float:
        """Return the width of `WIDTHS` that leaves the slope least unknown [pixels]."""
        return min(WIDTHS, key=lambda width: self.unknown(width=width, noise=noise).slope)
