"""What a pixel truly looks at, and what became of it: truth beside the measurement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.cloud.georeference import WaterPath, bend_at_surface, bend_at_waves
from survey.cloud.points import Outcome, PointClass
from survey.flight.pose import Pose
from survey.optics.water import WaterColumn
from terrain.raycast import cast_rays
from terrain.sea_surface import SeaSurface
from terrain.substrate import UNLABELLED

if TYPE_CHECKING:
    from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

FALSE_BOTTOM_ERROR = 1.0
ROOM_FOR_WAVES = 10.0  # [m]


@dataclass(frozen=True, kw_only=True)
class TrueTargets:
    """Where the unscattered rays of the pixel centres end, through the waves that are resolved.

    Parameters
    ----------
    surface : array (rows, columns, 3)
        Where they meet the water; on land, the land [m].
    normal : array (rows, columns, 3)
        Unit normal of the water there; nan on land.
    position : array (rows, columns, 3)
        Where they meet seabed or land [m]; nan where there is none.
    time : array (rows, columns)
        Two-way time to `position` [s].
    water_path : array (rows, columns)
        One-way path in water to `position` [m]; 0 on land, nan where there is none.
    depth : array (rows, columns)
        Of `position` under mean level, negative on land [m].
    classification : array (rows, columns)
        `PointClass`: ground, bathymetric point or submerged object.
    reflectance : array (rows, columns)
        Of seabed or land there [1]; nan where there is none.
    substrate : array (rows, columns)
        Code of what seabed or land is made of there; 0 where there is none.
    """

    surface: FloatArray
    normal: FloatArray
    position: FloatArray
    time: FloatArray
    water_path: FloatArray
    depth: FloatArray
    classification: NDArray[np.uint8]
    reflectance: FloatArray
    substrate: NDArray[np.uint8]


def true_targets(
    *,
    seabed: Seabed,
    surface: SeaSurface,
    water: WaterColumn,
    pose: Pose,
    rays: FloatArray,
    time: float = 0.0,
) -> TrueTargets:
    """Trace rays (rows, columns, 3) from the sensor through the sea of a time [s] to the seabed."""
    position = pose.position
    path = _bent(surface, position, rays, time, water.refractive_index)
    air_length = np.linalg.norm(path.entry - position, axis=-1)
    land_length, land_face = _cast(seabed, np.broadcast_to(position, rays.shape), rays, air_length)
    dry = land_face >= 0
    length, face = _cast(seabed, path.entry, path.direction, np.full(dry.shape, np.inf))
    found = np.where(
        dry[..., None],
        position + rays * np.where(dry, land_length, 0.0)[..., None],
        path.entry + path.direction * np.where(face >= 0, length, np.nan)[..., None],
    )
    in_water = path.air_time + path.air_time / air_length * water.group_index * length
    met = np.where(dry, land_face, face)
    substrate = np.where(met >= 0, seabed.substrate[np.maximum(met, 0)], UNLABELLED)
    is_object = seabed.is_object[np.maximum(face, 0)] & (face >= 0)
    wet_class = np.where(is_object, PointClass.SUBMERGED_OBJECT, PointClass.BATHYMETRIC)
    return TrueTargets(
        surface=np.where(dry[..., None], found, path.entry),
        normal=np.where(dry[..., None], np.nan, path.normal),
        position=found,
        time=np.where(dry, path.air_time / air_length * land_length, in_water),
        water_path=np.where(dry, 0.0, np.where(face >= 0, length, np.nan)),
        depth=surface.level - found[..., 2],
        classification=np.where(dry, PointClass.GROUND, wet_class).astype(np.uint8),
        reflectance=np.where(met >= 0, seabed.reflectance[np.maximum(met, 0)], np.nan),
        substrate=substrate.astype(np.uint8),
    )


def _bent(
    surface: SeaSurface, position: FloatArray, rays: FloatArray, time: float, index: float
) -> WaterPath:
    level = bend_at_surface(
        position=position, rays=rays, level=surface.level, refractive_index=index
    )
    if surface.waves is None:
        return level
    west, south = level.entry[..., :2].min(axis=(0, 1)) - ROOM_FOR_WAVES
    east, north = level.entry[..., :2].max(axis=(0, 1)) + ROOM_FOR_WAVES
    waves = surface.sheet(time=time, west=west, east=east, south=south, north=north)
    return bend_at_waves(position=position, rays=rays, waves=waves, refractive_index=index)


def outcomes(
    *,
    targets: TrueTargets,
    error: FloatArray,
    found: BoolArray,
    noise: BoolArray,
    saturated: BoolArray,
    probability: FloatArray,
    gate: tuple[float, float],
    shallowest: float,
) -> NDArray[np.uint8]:
    """Return the `Outcome` of every pixel.

    Parameters
    ----------
    targets : TrueTargets
    error : array (rows, columns)
        Measured less true elevation of the bottom point [m].
    found, noise, saturated : array (rows, columns)
        Whether a bottom was reported, whether one was found and sorted out, and whether the
        detector was blind when it should have been.
    probability : array (rows, columns)
        Probability that the true echo fires.
    gate : (float, float)
        First and last time that was looked at [s].
    shallowest : float
        Depth down to which the bottom echo merges with the surface's [m].
    """
    inside = (targets.time >= gate[0]) & (targets.time <= gate[1])
    wrong = ~(np.abs(error) <= FALSE_BOTTOM_ERROR)
    rules = (
        (targets.classification == PointClass.GROUND, Outcome.DRY),
        (found & wrong, Outcome.FALSE_BOTTOM),
        (found, Outcome.FOUND),
        (noise, Outcome.NOISE),
        (saturated, Outcome.SATURATED),
        (~inside, Outcome.OUTSIDE_GATE),
        (targets.depth < shallowest, Outcome.MERGED_WITH_SURFACE),
        (probability < 0.5, Outcome.TOO_DEEP),
    )
    return np.select(
        [rule for rule, _ in rules], [int(outcome) for _, outcome in rules], int(Outcome.CHANCE)
    ).astype(np.uint8)


def _cast(
    seabed: Seabed, origins: FloatArray, rays: FloatArray, limit: FloatArray
) -> tuple[FloatArray, NDArray[np.int64]]:
    length, face = cast_rays(
        seabed.grid, origins.reshape(-1, 3), rays.reshape(-1, 3), limit.reshape(-1)
    )
    return length.reshape(limit.shape), face.reshape(limit.shape)
