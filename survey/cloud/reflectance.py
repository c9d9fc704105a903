"""From the counts of an echo to the reflectance of what sent it back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from survey.cloud.noise import NoiseModel, gate_sums
from survey.cloud.points import NOISE_CLASSES, PointClass, PointCloud
from survey.cloud.scattering import Scattering
from survey.flight.pose import Frame
from survey.optics.interface import fresnel_reflectance
from survey.transport.expected_light import ExpectedLight

FloatArray = NDArray[np.float64]

TYPICAL_REFLECTANCE = 0.1
NO_ECHO = (*NOISE_CLASSES, PointClass.NO_BOTTOM_FOUND)


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """The lidar equation that the survey expects, turned round.

    A diffuse bottom of reflectance r at nadir sends back the counts
    N = E T^2 (r / pi) A / (n H + z)^2 W(z), E the photo-electrons of the light launched into a
    pixel for each square metre of aperture A, T the surface's transmission at nadir, W the two-way
    transmission of the expected water with the share of the echo that lies in the gate and is
    counted; off nadir as in `survey.transport.expected_light.ExpectedLight`. Over land n, T and W
    are those of air. Water's own echo gets the reflectance of land as bright.

    A depth that is measured too large by d makes a bottom too bright by exp(2 K d) nearly, K_d of
    the water for K: 0.18 m in harbor water, where scattered light comes so late, makes 22 %.

    Departures: slanting light goes as deep as vertical light of the same path; the bed is level;
    light that scatters in from neighbours of another reflectance counts as the pixel's own.

    Parameters
    ----------
    launched : float
        E A at nadir [m2].
    refractive_index : float
        Of the water [1].
    path : array (m,)
        Half the path in the water, growing from 0 [m].
    kept : array (m,)
        W there [1].
    """

    launched: float
    refractive_index: float
    path: FloatArray
    kept: FloatArray

    @classmethod
    def expected(
        cls, light: ExpectedLight, noise: NoiseModel, *, depths: Sequence[float]
    ) -> Calibration:
        """Return the calibration by the expected light of a few pixels.

        W is the median over these pixels of what the gate reads of a bottom of reflectance 0.1,
        by the detector's mean response on top of the water's light, over the equation without W.

        Parameters
        ----------
        light : ExpectedLight
        noise : NoiseModel
            Of the same pixels.
        depths : sequence of float
            Growing from near 0 [m].
        """
        paths, kept = [], []
        for depth in depths:
            path = light.paths(depth)
            bottom = light.bottom(depth=depth, reflectance=TYPICAL_REFLECTANCE)
            read = noise.detector.added(noise.bottomless_light, bottom, noise.bottomless)
            counts = gate_sums(read, noise.gate_bins).max(axis=-1)
            whole = light.geometry(path) * TYPICAL_REFLECTANCE / np.pi
            paths.append(float(np.median(path)))
            kept.append(float(np.median(counts / whole)))
        return cls(
            launched=light.launched,
            refractive_index=light.refractive_index,
            path=np.array(paths),
            kept=np.array(kept),
        )

    def applied(self, cloud: PointCloud, *, frame: Frame, scattering: Scattering) -> PointCloud:
        """Return the points of a frame with their reflectance, nan where there is no echo.

        What the counts miss for the water that a bottom hides is added as ``scattering`` tells.
        """
        ray = cloud.uncorrected - frame.measured.position
        told = self.reflectance(
            cloud.counts,
            slant=np.linalg.norm(ray, axis=1) / -ray[:, 2],
            height=frame.measured.position[2] - cloud.position[:, 2] - cloud.depth,
            depth=cloud.depth,
        )
        reflectance = scattering.reflectance(told, depth=cloud.depth)
        echo = ~np.isin(cloud.classification, NO_ECHO)
        return replace(cloud, reflectance=np.where(echo, reflectance, np.nan).astype(np.float32))

    def reflectance(
        self,
        counts: NDArray[np.floating],
        *,
        slant: FloatArray,
        height: FloatArray | float,
        depth: FloatArray,
    ) -> FloatArray:
        """Return the reflectance of what sends back counts (...) [1].

        Parameters
        ----------
        counts : array (...)
            In the gate of the echo.
        slant : array (...)
            Way in air over height [1].
        height : array (...)
            Of the sensor above the water; over land above the land [m].
        depth : array (...)
            Of the bottom; 0 over land [m].
        """
        wet = depth > 0.0
        in_water = 1.0 / np.sqrt(1.0 - (1.0 - slant**-2.0) / self.refractive_index**2)
        path = np.where(wet, depth * in_water, 0.0)
        index = np.where(wet, self.refractive_index, 1.0)
        lost = np.where(wet, fresnel_reflectance(1.0, 1.0 / self.refractive_index), 0.0)
        reach = index * height * slant + path
        whole = self.launched * (1.0 - lost) ** 2 / (reach * slant) ** 2 / np.pi
        kept = np.exp(np.interp(path, self.path, np.log(np.maximum(self.kept, 1e-300))))
        return np.asarray(counts / (whole * kept))
