"""Photo-electrons that every pixel may expect, by the lidar equation and a water's response."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.optics.interface import fresnel_reflectance
from survey.optics.water_response import WaterResponse
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.scene import kernel_sea
from survey.transport.surface import glint_per_steradian
from survey.transport.waveforms import blurred, padded_bins, pulse_taps
from terrain.sea_surface import SeaSurface

FloatArray = NDArray[np.float64]

AT_ONCE = np.array([0.0, 1e-3])


@dataclass(frozen=True, kw_only=True)
class ExpectedLight:
    """A level sensor over a level sea and a level bottom; the sum of what `Engine.flash` traces.

    Nearest to nadir it is P = E T^2 (rho / pi) A / (n H + z)^2 with the two-way transmission of
    the water in place of exp(-2 c z). Departures: slanting light is that of a vertical path as
    long, which in layered water goes deeper, and Fresnel's losses are those at nadir.

    Parameters
    ----------
    height : float
        Of the sensor above the water [m].
    laser, receiver : Laser, Receiver
    camera : Camera
        Which way pixels look; for speed it may have fewer than the true one.
    pixel_solid_angle : float
        Of a true pixel, at nadir [sr].
    photo_electrons_per_photon : float
        Optics transmission x detection efficiency [1].
    surface : SeaSurface
    water : WaterResponse
    refractive_index, group_index : float
        Of the water [1].
    """

    height: float
    laser: Laser
    receiver: Receiver
    camera: Camera
    pixel_solid_angle: float
    photo_electrons_per_photon: float
    surface: SeaSurface
    water: WaterResponse
    refractive_index: float
    group_index: float

    def bottom(self, *, depth: float, reflectance: float) -> FloatArray:
        """Return the light of a bottom (rows, columns, bins) [photo-electrons].

        Parameters
        ----------
        depth : float
            [m].
        reflectance : float
            [1].
        """
        table = self.water.table
        path = self.paths(depth)
        share = table.late_share_at(float(np.median(path)))
        light = self.geometry(path) * table.two_way_at(path) * reflectance / np.pi
        edges = path[..., None] + table.late_edges
        return self._binned(edges, light[..., None] * share)

    def paths(self, depth: float) -> FloatArray:
        """Return half the pixels' paths in water (rows, columns) to a bottom at a depth [m]."""
        return np.asarray(depth * self._in_water(self._slant))

    def column(self) -> FloatArray:
        """Return the light of bottomless water (rows, columns, bins) [photo-electrons]."""
        edges = np.broadcast_to(
            self.water.table.column_edges, (*self.camera.shape, len(self.water.table.column_edges))
        )
        path = 0.5 * (edges[..., 1:] + edges[..., :-1])
        light = self.geometry(path) * self.water.table.column * np.diff(edges, axis=-1)
        return self._binned(edges, light)

    def surface_echo(self) -> FloatArray:
        """Return the light of the surface itself (rows, columns, bins) [photo-electrons].

        A mirror shows the laser in a single pixel; here it shows nothing.
        """
        if self.surface.slope_variance == 0.0:
            return np.zeros((*self.camera.shape, self.receiver.bins))
        sea, index = kernel_sea(self.surface), self.refractive_index
        forward, right = self.camera.pixel_centres()
        glint = np.array(
            [
                glint_per_steradian(sea, index, f / s, r / s, -1.0 / s)
                for f, r, s in zip(forward.flat, right.flat, self._slant.flat, strict=True)
            ]
        ).reshape(forward.shape)
        # per power on the water; the light on it is per area
        light = self.launched * glint / (self.height * self._slant) ** 2 / self._slant
        edges = np.broadcast_to(AT_ONCE, (*self.camera.shape, 2))
        return self._binned(edges, light[..., None])

    @property
    def bin_depths(self) -> FloatArray:
        """Depth straight below whose echo lies in the middle of each bin (bins,) [m]."""
        receiver = self.receiver
        times = receiver.gate_start + (np.arange(receiver.bins) + 0.5) * receiver.bin_width
        return np.asarray((0.5 * speed_of_light * times - self.height) / self.group_index)

    @property
    def gate_depth(self) -> float:
        """Deepest bottom of which all pixels have the first half of the echo in the gate [m]."""
        forward, right = self.camera.half_tangents
        slant = np.sqrt(1.0 + forward**2 + right**2)
        end = self.receiver.gate_end - 0.5 * self.laser.pulse_fwhm
        path = (0.5 * speed_of_light * end - self.height * slant) / self.group_index
        return float(max(path / self._in_water(slant), 0.0))

    @property
    def _slant(self) -> FloatArray:
        """1 / cosine of the pixels' angle off nadir."""
        forward, right = self.camera.pixel_centres()
        return np.asarray(np.sqrt(1.0 + forward**2 + right**2))

    def _in_water(self, slant: Any) -> Any:
        """Return 1 / cosine in the water for that in air."""
        return 1.0 / np.sqrt(1.0 - (1.0 - slant**-2.0) / self.refractive_index**2)

    @property
    def launched(self) -> float:
        """Photo-electrons of the light launched into a pixel, times the aperture's area [m2]."""
        forward, right = self.camera.half_tangents
        share = self.pixel_solid_angle / (4.0 * forward * right)
        electrons = self.laser.photons_per_pulse * self.photo_electrons_per_photon
        return electrons * share * self.receiver.aperture_area

    def geometry(self, path: FloatArray) -> FloatArray:
        """Return photo-electrons for each unit of radiance over irradiance [1]."""
        slant = self._slant.reshape(self._slant.shape + (1,) * (path.ndim - 2))
        index = self.refractive_index
        passed = (1.0 - fresnel_reflectance(1.0, 1.0 / index)) ** 2
        reach = index * self.height * slant + path
        return np.asarray(self.launched * passed / reach**2 / slant**2)

    def _binned(self, edges: FloatArray, light: FloatArray) -> FloatArray:
        """Return light spread between edges of half the path in water, as the gate sees it."""
        receiver, sigma = self.receiver, self.laser.pulse_sigma
        bins, pad = padded_bins(
            start=receiver.gate_start, width=receiver.bin_width, bins=receiver.bins, sigma=sigma
        )
        times = bins.start + np.arange(bins.number + 1) * bins.width
        gathered = np.zeros((*light.shape[:-1], light.shape[-1] + 1))
        np.cumsum(light, axis=-1, out=gathered[..., 1:])
        arrival = (
            2.0 / speed_of_light * (self.height * self._slant[..., None] + self.group_index * edges)
        )
        pixels = zip(
            arrival.reshape(-1, arrival.shape[-1]),
            gathered.reshape(-1, gathered.shape[-1]),
            strict=True,
        )
        histogram = np.array([np.diff(np.interp(times, at, sums)) for at, sums in pixels])
        taps = pulse_taps(sigma=sigma, width=receiver.bin_width, pad=pad)
        return np.asarray(blurred(histogram, taps).reshape(*self.camera.shape, receiver.bins))
