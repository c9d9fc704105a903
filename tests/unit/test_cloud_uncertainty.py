"""Uncertainties against brute force: sampled errors, made again from pose, water and time."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from survey.cloud.displacements import Displacements
from survey.cloud.georeference import bend_at_slopes, place_in_water
from survey.cloud.local_surface import fitted_planes
from survey.cloud.points import PointClass
from survey.cloud.radius import radius_95
from survey.cloud.scattering import LevelBottom, Scattering
from survey.cloud.time_noise import time_noise
from survey.cloud.wave_statistics import WaveStatistics
from survey.flight.navigation import PoseUncertainty
from survey.flight.pose import Pose
from survey.products.uncertainty_check import UncertaintyTally, footprint_places
from survey.sensor.camera import Camera
from terrain.waves import Swell, WaveField, WindSea

FloatArray = NDArray[np.float64]
INDEX, GROUP = 1.3415, 1.36


@pytest.mark.parametrize(
    ("deviations", "half_side"),
    [((1.0, 1.0), 0.0), ((1.0, 0.4), 0.0), ((0.0, 0.0), 1.0), ((0.3, 0.3), 1.0), ((0.7, 0.1), 1.0)],
)
def test_the_radius_holds_95_of_a_hundred(
    deviations: tuple[float, float], half_side: float
) -> None:
    chance = np.random.default_rng(1)
    errors = chance.normal(size=(200_000, 2)) * deviations
    errors += chance.uniform(-1.0, 1.0, errors.shape) * half_side
    radius = radius_95(covariance=np.diag(np.square(deviations)), half_side=half_side)
    assert np.quantile(np.hypot(*errors.T), 0.95) == pytest.approx(radius, rel=0.02)


@pytest.mark.parametrize(("counts", "noise_per_bin"), [(2000.0, 0.0), (3000.0, 400.0)])
def test_counting_noise_is_that_of_drawn_echoes(counts: float, noise_per_bin: float) -> None:
    """Crests of 4,000 drawn echoes, found by a fine search: nothing of the ranging is used."""
    sigma, width = 4.25e-9, 0.5e-9
    edges = (np.arange(141) - 70.0) * width
    middle = 0.5 * (edges[1:] + edges[:-1])
    pulse = np.exp(-0.5 * (middle / sigma) ** 2)
    drawn = np.random.default_rng(2).poisson(
        counts * pulse / pulse.sum() + noise_per_bin, (4000, len(middle))
    )
    lags = np.linspace(-3e-9, 3e-9, 241)
    filters = np.exp(-0.5 * ((middle - lags[:, None]) / sigma) ** 2)
    found = lags[((drawn - noise_per_bin) @ filters.T).argmax(axis=1)]
    in_gate = counts + noise_per_bin * np.sqrt(8.0 * np.log(2.0)) * sigma / width
    expected = time_noise(
        counts=np.array(counts), snr=np.array(counts / np.sqrt(in_gate)), pulse_sigma=sigma
    )
    assert found.std() == pytest.approx(expected, rel=0.06)


def test_displacements_are_those_of_sampled_errors(look_at: Any) -> None:
    """2,500 draws of pose, level, slope and time, each placed anew, for five points."""
    look = look_at(depth=8.0, gradient=0.0, roll_deg=4.0, pitch_deg=-3.0, level=0.4)
    camera = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
    row, column = np.array([0, 0, 16, 31, 31]), np.array([0, 63, 32, 0, 63])
    time = look.targets.time[row, column]
    pose = PoseUncertainty(
        position=(0.05, 0.04, 0.06), lever_arm=(0.0, 0.03, 0.0), roll=4e-4, pitch=3e-4, heading=9e-4
    )
    moves = Displacements(
        camera=camera,
        frame=look.frame,
        row=row.astype(np.uint16),
        column=column.astype(np.uint16),
        time=time,
        wet=np.ones(5, np.bool_),
        level=0.4,
        refractive_index=INDEX,
        group_index=GROUP,
    )
    late, high, steep = 2e-10, 0.1, 0.06
    vectors = np.concatenate(
        [
            moves.of_pose(pose),
            moves.of_slopes() * steep,
            moves.of_level()[None] * high,
            moves.of_time()[None] * late,
        ]
    )
    predicted = np.einsum("kni,knj->nij", vectors, vectors)
    drawn = sampled_places(look.frame.pose, camera, row, column, time, pose, (late, high, steep))
    centred = drawn - drawn.mean(axis=0)
    sampled = np.einsum("kni,knj->nij", centred, centred) / len(drawn)
    scale = np.sqrt(np.einsum("nii,njj->nij", sampled, sampled))
    assert (np.abs(predicted - sampled) / scale).max() < 0.07


def sampled_places(
    true: Pose,
    camera: Camera,
    row: NDArray[np.int64],
    column: NDArray[np.int64],
    time: FloatArray,
    pose: PoseUncertainty,
    other: tuple[float, float, float],
    draws: int = 2_500,
) -> FloatArray:
    """Return places (draws, n, 3) with errors drawn; the level follows the mean of all rays."""
    chance = np.random.default_rng(3)
    late, high, steep = other
    forward, right = (each[row, column] for each in camera.pixel_centres())
    body = np.stack([forward, right, np.ones(len(row))], axis=-1)
    body /= np.linalg.norm(body, axis=-1, keepdims=True)
    before = body @ true.body_to_map().T
    places = np.empty((draws, len(row), 3))
    for k in range(draws):
        turned = replace(
            true,
            roll=true.roll + chance.normal() * pose.roll,
            pitch=true.pitch + chance.normal() * pose.pitch,
            heading=true.heading + chance.normal() * pose.heading,
        )
        lever = true.body_to_map() @ (chance.normal(size=3) * pose.lever_arm)
        moved = chance.normal(size=3) * pose.position + lever
        rays = body @ turned.body_to_map().T
        reach = (0.4 - true.position[2]) / before[:, 2]
        follows = moved[2] + float(np.mean((rays - before)[:, 2] * reach))
        level = 0.4 + follows + chance.normal() * high
        position = true.position + moved
        path = bend_at_slopes(
            position=position,
            rays=rays,
            length=(level - position[2]) / rays[:, 2],
            slopes=np.broadcast_to(chance.normal(size=2) * steep, (len(row), 2)),
            refractive_index=INDEX,
        )
        places[k] = place_in_water(path=path, time=time + chance.normal() * late, group_index=GROUP)
    return places


@pytest.mark.parametrize("width", [1.0, 2.0])
def test_planes_leave_of_waves_what_their_spectrum_says(width: float) -> None:
    """A drawn sea, pixels averaged over 8 x 8 of its nodes, planes fitted, slopes compared."""
    waves = WaveField.realised(
        wind_sea=WindSea.fetch_limited(wind_speed=7.0, fetch=10e3),
        swell=[Swell(height=0.5, period=6.0, comes_from=1.0)],
        patch=128.0,
        shortest=1.0,
        chance=np.random.default_rng(4),
    )
    sheet = waves.lattice(time=0.0, level=0.0, west=0.0, east=255.9, south=0.0, north=255.9)
    fine = sheet.coefficients[:1024, :1024]
    spacing, side = 1.0 / sheet.per_cell, 8
    pixel = side * spacing
    pixels = fine.reshape(128, side, 128, side).mean(axis=(1, 3))
    noise = 0.03
    measured = pixels + np.random.default_rng(5).normal(0.0, noise, pixels.shape)
    place = np.stack([*np.meshgrid(np.arange(128) * pixel, np.arange(128) * pixel), measured], -1)
    planes = fitted_planes(places=place, used=np.ones((128, 128), np.bool_), width=width)
    north, east = np.gradient(fine, spacing)
    middle = (slice(side // 2, None, side),) * 2
    left = planes.slope - np.stack([east[middle], north[middle]], axis=-1)
    expected = WaveStatistics.of_elevations(fine, spacing=spacing, pixel=pixel).unknown(
        width=width, noise=noise
    )
    inside = (slice(8, -8),) * 2
    assert np.sqrt(np.mean(left[inside] ** 2)) == pytest.approx(expected.slope, rel=0.12)
    off = (planes.elevation - fine[middle])[inside]
    assert off.std() == pytest.approx(expected.height, rel=0.15)


def test_still_water_is_known_and_neighbourhoods_are_wide() -> None:
    still = WaveStatistics.still(2.0)
    assert still.unknown().slope == still.unknown().height == 0.0
    assert still.best_width(noise=0.02) == 6.0


def test_a_table_takes_off_what_it_was_made_of() -> None:
    chance = np.random.default_rng(6)
    tangent = chance.uniform(0.0, 0.28, 2000)
    along = tangent * chance.uniform(-1.0, 1.0, 2000)
    edge = chance.uniform(0.0, 20.0, (2000, 2))
    brightness = chance.uniform(0.0, 2.0, 2000)

    def bottom(depth: float) -> LevelBottom:
        rim = 0.01 * depth * np.exp(-4.0 * edge / depth).sum(axis=-1)
        error = -0.02 * depth + 0.05 * depth * tangent**2 + rim + chance.normal(0.0, 0.01, 2000)
        seen = np.where(brightness > 0.1, brightness, np.nan)
        return LevelBottom(
            depth=depth,
            tangent=tangent,
            error=error,
            edge=edge,
            along=along,
            origin=-0.04 * depth * along + chance.normal(0.0, 0.05, 2000),
            surface_late=1e-9 * tangent,
            brightness=brightness,
            second_error=error - 0.01 * depth * (1.0 - 1.0 / seen),
            told=(seen - 0.1) / (1.0 - 0.1),
        )

    table = Scattering.fitted([bottom(depth) for depth in (2.0, 4.0, 8.0)])
    assert table.shift == pytest.approx(0.04 * np.array([0.0, 2.0, 4.0, 8.0]), abs=0.03)
    assert table.bias_bright == pytest.approx(-0.01 * np.array([2.0, 2.0, 4.0, 8.0]), rel=1e-6)
    assert table.hidden == pytest.approx(0.1 * 0.15, rel=1e-6)
    assert table.residual == pytest.approx(0.01, rel=0.1)
    rays = np.array([0.2, 0.0, -1.0])
    error = -0.02 * 6.0 + 0.05 * 6.0 * 0.04 + 0.01 * 6.0 * (1.0 + np.exp(-1.0))
    faint = -0.01 * 6.0 * (1.0 - 0.15 / 0.1)
    fixed = table.corrected(
        np.array([40.0, 0.0, -6.0 + error + faint]),
        rays=rays,
        edge=np.array([0.0, 1.5]),
        level=0.0,
        reflectance=lambda depth: np.full_like(depth, 0.1 - 0.1 * 0.15),
    )
    assert fixed[2] == pytest.approx(-6.0, abs=0.005)
    assert fixed[0] == pytest.approx(40.0 - 0.2 * 0.04 * 6.0, abs=0.01)
    assert np.interp(0.14, table.surface_tangent, table.surface_late) == pytest.approx(
        0.14e-9, rel=0.02
    )


def test_coverage_is_that_of_drawn_errors(small_survey: Any) -> None:
    cloud, chance = small_survey.bottom, np.random.default_rng(7)
    sigma = 0.1
    position = cloud.truth.copy()
    position[:, :2] += chance.normal(0.0, 0.3, (len(cloud), 2))
    position[:, 2] = small_survey.elevation_at(*position[:, :2].T) + chance.normal(
        0.0, sigma, len(cloud)
    )
    half = 0.5 * 0.008 * 205.0
    radius = float(radius_95(covariance=0.09 * np.eye(2), half_side=half))
    drawn = replace(
        cloud,
        position=position,
        true_elevation=small_survey.elevation_at(*position[:, :2].T),
        classification=np.full(len(cloud), PointClass.BATHYMETRIC, np.uint8),
        tvu=np.full(len(cloud), 1.96 * sigma, np.float32),
        thu=np.full(len(cloud), radius, np.float32),
    )
    tally = UncertaintyTally(
        frames=small_survey.frames, pixel_tangent=0.008, refractive_index=INDEX
    )
    half_way = np.arange(len(drawn)) < 1000
    tally.add(drawn.select(half_way))
    tally.add(drawn.select(~half_way))
    found = tally.metrics()
    assert found["tvu_coverage"] == pytest.approx(0.95, abs=0.012)
    assert found["thu_coverage"] == pytest.approx(0.95, abs=0.015)
    assert sum(one["points"] for one in found["uncertainty_by_depth"]) == len(cloud)


def test_places_fill_footprints_to_their_corners(small_survey: Any) -> None:
    """The share within 1.2 half sides of the centre is that of the square's area: 95.1 %."""
    within = 1.2
    beyond = 4.0 * (within**2 * np.arccos(1.0 / within) - np.sqrt(within**2 - 1.0))
    exact = (np.pi * within**2 - beyond) / 4.0
    cloud = replace(
        small_survey.bottom,
        depth=np.zeros(len(small_survey.bottom)),
        truth=small_survey.bottom.truth * [1.0, 1.0, 0.0],
    )
    places = footprint_places(
        cloud, frames=small_survey.frames, pixel_tangent=0.008, refractive_index=INDEX
    )
    off = places - cloud.truth[:, None, :2]
    height = np.mean([frame.pose.position[2] for frame in small_survey.frames])
    half = 0.5 * 0.008 * height
    assert np.mean(np.hypot(off[..., 0], off[..., 1]) <= within * half) == pytest.approx(
        exact, abs=0.002
    )
    assert exact == pytest.approx(0.951, abs=0.0005)


def test_no_bottom_has_no_coverage(small_survey: Any) -> None:
    nothing = small_survey.bottom.select(np.zeros(0, np.intp))
    tally = UncertaintyTally(
        frames=small_survey.frames, pixel_tangent=0.008, refractive_index=INDEX
    )
    tally.add(nothing)
    found = tally.metrics()
    assert found["tvu_coverage"] is None
    assert found["uncertainty_by_depth"] == []
