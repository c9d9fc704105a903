"""What scattering does to the points of a mission, told by flashes over level bottoms."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from math import inf, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.bottom_search import BottomSearch
from survey.cloud.georeference import WaterPath, bend_at_surface, pixel_rays, place_in_water
from survey.cloud.noise import NoiseModel, gate_sums
from survey.cloud.ranging import first_echo
from survey.cloud.scattering import TABLE_REFLECTANCE, LevelBottom, Scattering, off_nadir
from survey.flight.pose import Frame
from survey.sensor.camera import Camera
from survey.transport.engine import Engine
from survey.transport.waveforms import Waveforms
from terrain.generators import Ground, plane
from terrain.map_frame import MapFrame
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]

FIRST_FRAME = (1 << 31) + 64
SHALLOWEST, DEEPENING = 2.0, 1.7
TRIES, LEAST_DEEPENING = 9, 1.1
FIRST_BOUNCE_DEPTHS, FIRST_BOUNCE_GATES = 0.5, 1.25
"""How far under the bottom, the larger of both, light may come from that touched it once.

Half way to the second bounce, but not within the pulse of the first: at half of 2 m the cut would
move a bottom of coastal water by 0.01 m.
"""
CELL = 1.0  # [m]
BEYOND = 25.0  # how far the bottom goes on beyond the view [m]
ENOUGH, FEWEST = 0.5, 32  # share and number of pixels with an echo


@dataclass(frozen=True, kw_only=True)
class LevelBottoms:
    """Flashes over level bottoms in the expected water, and the ranging that a mission uses.

    A bottom whose reflectance grows along an axis, lit and seen by the same walks as an even one,
    tells by its brightness where on the axis the light of a pixel was reflected, and what the
    brightness of a bottom does to its range.

    Parameters
    ----------
    engine : callable
        From a seabed to the engine over it.
    search : type
        How the mission looks for the bottom.
    noise : NoiseModel
        Of the level sensor.
    frame : Frame
        A level pose over the origin.
    camera : Camera
    level : float
        Elevation of the water [m].
    map_frame : MapFrame
        Of the seabeds.
    """

    engine: Callable[[Seabed], Engine]
    search: type[BottomSearch]
    noise: NoiseModel
    frame: Frame
    camera: Camera
    level: float
    map_frame: MapFrame

    def expected_errors(self) -> Scattering:
        """Return the table; it ends where half of the pixels, or all but 31, have no echo."""
        return Scattering.fitted(list(self._bottoms()))

    def _bottoms(self) -> Iterator[LevelBottom]:
        """Yield bottoms of growing depth; from the first that is too deep on, by halving."""
        depth, deepening, too_deep = SHALLOWEST / DEEPENING, DEEPENING, inf
        for number in range(TRIES):
            bottom = self._bottom(depth * deepening, FIRST_FRAME + number)
            if bottom is None:
                too_deep = depth * deepening
            else:
                depth = bottom.depth
                yield bottom
            deepening = min(DEEPENING, sqrt(too_deep / depth))
            if deepening < LEAST_DEEPENING:
                return

    def _bottom(self, depth: float, number: int) -> LevelBottom | None:
        pose = self.frame.pose
        forward, right, _ = pose.body_to_map().T
        axis = (forward if self.camera.long_side == "along" else right)[:2]
        even = self._even_bed(depth)
        engines = [self.engine(bed) for bed in (even, _growing(even, axis, self._half_length))]
        with ThreadPoolExecutor(2) as both:
            light, uneven = both.map(lambda one: one.flash(pose=pose, frame=number), engines)
        rays, engine = pixel_rays(camera=self.camera, pose=pose), engines[0]
        path = bend_at_surface(
            position=pose.position,
            rays=rays,
            level=self.level,
            refractive_index=engine.water.refractive_index,
        )
        late, measured, counts = self._measured(engine, light, path, depth)
        _, second, more = self._measured(engine, uneven, path, depth)
        found = np.isfinite(measured) & np.isfinite(late)
        if found.mean() < ENOUGH or found.sum() < FEWEST:
            return None
        brightness = self._gain(uneven, light)
        found &= np.isfinite(brightness)
        if found.sum() < FEWEST:
            return None
        tangents = rays[..., :2] / -rays[..., 2:]
        centre = path.entry + path.direction * (depth / -path.direction[..., 2])[..., None]
        return LevelBottom(
            depth=depth,
            tangent=off_nadir(rays)[found],
            error=measured[found] - (self.level - depth),
            edge=self.camera.edge_distances(height=pose.position[2] - self.level)[found],
            along=(tangents @ axis)[found],
            origin=(self._half_length * (brightness - 1.0) - centre[..., :2] @ axis)[found],
            surface_late=late[found],
            brightness=brightness[found],
            second_error=second[found] - (self.level - depth),
            told=(more / counts)[found],
        )

    def _even_bed(self, depth: float) -> Seabed:
        ground = Ground(
            map_frame=self.map_frame,
            length=2.0 * self._half_length,
            width=2.0 * self._half_length,
            axis=self.frame.pose.heading,
            reflectance=TABLE_REFLECTANCE,
        )
        return plane(ground=ground, depth=depth - self.level, spacing=CELL)

    @property
    def _half_length(self) -> float:
        """How far the beds reach from nadir [m]."""
        height = self.frame.pose.position[2] - self.level
        return float(max(self.camera.half_tangents) * height + BEYOND)

    def _measured(
        self, engine: Engine, light: Waveforms, path: WaterPath, depth: float
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return lateness of the surface [s], elevation [m] and counts of the bottom.

        By the mean readings. The bottom's is told from water at its true level, and from light that
        touched it once.
        """
        noise = self.noise
        end = self._end_of_first_bounce(path, depth, engine.water.group_index)
        bins = noise.bin_start + noise.bin_width * np.arange(light.total.shape[-1])
        counts = np.where(
            bins < end[..., None],
            noise.detector.mean(light.total + noise.steady_light),
            noise.bottomless,
        )
        first = first_echo(counts=counts, noise=noise)
        search = self.search.over(
            noise=noise, variance=light.variance[:2].sum(axis=0), surface_time=path.air_time
        )
        bottom = search.echo(counts)
        place = place_in_water(path=path, time=bottom.time, group_index=engine.water.group_index)
        return first.time - path.air_time, place[..., 2], bottom.counts

    def _end_of_first_bounce(self, path: WaterPath, depth: float, group_index: float) -> FloatArray:
        """Return until when light comes that touched the bottom once (rows, columns) [s]."""
        speed = speed_of_light / group_index
        gate = 0.5 * speed * self.noise.gate_bins * self.noise.bin_width
        reach = depth + max(FIRST_BOUNCE_DEPTHS * depth, FIRST_BOUNCE_GATES * gate)
        return np.asarray(path.air_time + 2.0 * reach / -path.direction[..., 2] / speed)

    def _gain(self, uneven: Waveforms, light: Waveforms) -> FloatArray:
        """Return by how much the bottom is brighter in the strongest gate of each pixel.

        nan where the bottom sends no light at all.
        """
        sums, more = (
            gate_sums(each.origin("bottom"), self.noise.gate_bins) for each in (light, uneven)
        )
        best = sums.argmax(axis=-1)[..., None]
        here, there = (np.take_along_axis(each, best, -1)[..., 0] for each in (sums, more))
        none = np.full(here.shape, np.nan)
        return np.asarray(np.divide(there, here, out=none, where=here > 0.0))


def _growing(bed: Seabed, axis: FloatArray, reach: float) -> Seabed:
    """Return a bed whose reflectance grows along an axis from 0 to twice its own at a reach."""
    place = bed.mesh.triangles_center[:, :2] @ axis
    return replace(bed, reflectance=bed.reflectance * (1.0 + place / reach))
