"""From a scenario to the parts of its mission, built once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, partial
from math import hypot
from threading import Lock

import numpy as np
from numpy.typing import NDArray

from survey.cloud.bottom_search import SEARCHES, BottomSearch
from survey.cloud.coincidence import Coincidence
from survey.cloud.georeference import depth_of
from survey.cloud.noise import NoiseModel
from survey.cloud.posed_noise import PosedNoise
from survey.cloud.ranging import surface_walk
from survey.cloud.raw import RawReadings, raw_readings
from survey.cloud.reflectance import Calibration
from survey.cloud.refraction import Refraction
from survey.cloud.scattering import Scattering
from survey.cloud.uncertainty import Budget
from survey.cloud.wave_statistics import WaveStatistics
from survey.expected_errors import LevelBottoms
from survey.expected_light import coarse, expected_light
from survey.flight.navigation import PoseUncertainty
from survey.flight.pose import Frame, Pose
from survey.flight.trajectory import footprints, require_air
from survey.optics.background import background_power
from survey.optics.water import WaterColumn
from survey.products.run_products import ProductSettings
from survey.scenario import components
from survey.scenario.scenario import Scenario
from survey.scenario.seabed_objects import cubes
from survey.sensor.camera import Camera
from survey.sensor.detector import Detector, Readings
from survey.transport.engine import Engine
from survey.transport.waveforms import Waveforms, pulse_taps
from terrain.generators import Ground, plane
from terrain.sea_surface import SeaSurface
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]

MODEL_FLASHES, ABREAST = 4, 2
FIRST_MODEL_FRAME = 1 << 31
SHALLOWEST_CALIBRATED = 0.1  # [m]
CALIBRATED_DEPTHS = 40
WAVE_PATCH = 512.0
RAW_STEPS = {"none": None, "sampled": 8, "all": 1}


@dataclass(frozen=True, kw_only=True)
class Mission:
    """The parts of a mission in SI units; `prepare` builds them.

    `engine` and `posed_noise` are those of mean level; `level_error` is how far the expected water
    level lies above the true one [m]; `scattering` returns the errors that scattered light is
    expected to make, worked out when first asked for; `second_look_rate` is None where the scenario
    wants no second look for weak echoes, or where no two frames see the same place.
    """

    frames: Sequence[Frame]
    camera: Camera
    detector: Detector
    seabed: Seabed
    sea: SeaSurface
    engine: Engine
    level_error: float
    search: type[BottomSearch]
    posed_noise: PosedNoise
    budget: Budget
    calibration: Calibration
    refraction: Refraction
    scattering: Callable[[], Scattering]
    products: ProductSettings
    raw_step: int | None
    second_look_rate: float | None

    @property
    def noise(self) -> NoiseModel:
        """The noise model of the level sensor."""
        return self.posed_noise.level

    def expected_level(self, time: float) -> float:
        """Return the elevation of the water that the survey expects at a time [s], [m]."""
        return self.sea.at(time).level + self.level_error

    def noise_at(self, pose: Pose, *, time: float = 0.0) -> NoiseModel:
        """Return the noise model at a measured pose, over the level expected at a time [s]."""
        rise = self.expected_level(time) - self.sea.level
        return self.posed_noise.at(replace(pose, position=pose.position - [0.0, 0.0, rise]))

    def raw_of(self, readings: Readings) -> RawReadings | None:
        """Return the part of the readings that is kept; None where none is."""
        if self.raw_step is None:
            return None
        return raw_readings(
            readings,
            step=self.raw_step,
            bin_start=self.noise.bin_start,
            bin_width=self.noise.bin_width,
        )


def prepare(scenario: Scenario, *, alike: Mission | None = None) -> Mission:
    """Build seabed, flight, engine and noise model, and refuse a flight that leaves the seabed.

    Parameters
    ----------
    scenario : Scenario
    alike : Mission, optional
        Of a scenario that differs in seabed, number of frames or sun alone: the light of its water
        is taken from there, and under the same sun what scattering does.

    Raises
    ------
    ValueError
        With every fault, each in a line of its own.
    """
    camera, surface = components.camera(scenario), components.sea_surface(scenario)
    frames, water = components.frames(scenario), components.water(scenario)
    seabed = components.seabed(scenario)
    seabed.require_coverage(footprints(camera, frames, surface.lowest_level))
    require_air(frames, highest=seabed.grid.z_high)
    noise = posed_noise(scenario, frames[0], surface, alike=alike.posed_noise if alike else None)
    settings = product_settings(scenario)
    return Mission(
        frames=frames,
        camera=camera,
        detector=components.detector(scenario),
        seabed=seabed,
        sea=surface,
        engine=_engine(scenario, seabed, water, surface),
        level_error=scenario.processing.water_level_error_m,
        search=SEARCHES[scenario.processing.ranging],
        posed_noise=noise,
        budget=Budget(
            camera=camera,
            pulse_sigma=_seen_pulse(scenario),
            refractive_index=water.refractive_index,
            group_index=water.group_index,
            pose=PoseUncertainty.of(components.navigation(scenario)),
            level_error=abs(scenario.processing.water_level_error_m),
        ),
        refraction=Refraction(
            local=scenario.processing.refraction == "local_waves",
            waves=_wave_statistics(surface, pixel=camera.pixel_tangent * scenario.flight.height_m),
            refractive_index=water.refractive_index,
        ),
        scattering=_expected_errors(scenario, noise, surface, alike),
        calibration=_calibration(scenario, frames[0], surface),
        products=settings,
        raw_step=RAW_STEPS[scenario.processing.keep_waveforms],
        second_look_rate=_second_look_rate(frames, settings),
    )


def product_settings(scenario: Scenario) -> ProductSettings:
    """Return what the products need to know of a scenario."""
    return ProductSettings(
        title=scenario.mission.title,
        description=scenario.mission.description,
        start_utc=scenario.mission.start_utc,
        water_level=components.sea_surface(scenario).level,
        thinning=scenario.processing.thinning_m,
        grid=scenario.processing.grid_m,
        pixel_spacing=components.camera(scenario).pixel_tangent * scenario.flight.height_m,
        survey_area=components.survey_area(scenario),
        trajectory_files=scenario.navigation.trajectory_files,
        deviations=components.navigation(scenario).deviations,
        water=components.water(scenario),
        camera=components.camera(scenario),
        order=scenario.mission.order,
        cubes=cubes(scenario),
        second_look=_second_look(scenario),
    )


def _second_look(scenario: Scenario) -> Coincidence | None:
    """Return how frames believe each other's weak echoes; None where each stands for itself."""
    given, receiver = scenario.processing, components.receiver(scenario)
    if given.ranging != "matched" or given.second_look_rate == 0.0:
        return None
    return Coincidence(
        candidate_rate=given.second_look_rate,
        false_alarm_rate=given.false_alarm_rate,
        depth_searched=depth_of(
            time=receiver.bins * receiver.bin_width,
            group_index=components.water(scenario).group_index,
        ),
    )


def _second_look_rate(frames: Sequence[Frame], settings: ProductSettings) -> float | None:
    """Return the rate of the second look, where it can be of use to another frame."""
    rule = settings.second_look
    if rule is None or not settings.views(frames, deepest=rule.depth_searched).any_meet():
        return None
    return rule.candidate_rate


def posed_noise(
    scenario: Scenario, frame: Frame, sea: SeaSurface, *, alike: PosedNoise | None = None
) -> PosedNoise:
    """Return what a flash reads over water without a bottom, and the thresholds above it.

    The column is that of the water that is expected, from flashes of its own over a bottom that
    nothing can reach; a survey would know it from its deep water. Of resolved waves it knows the
    slopes' statistics alone: all of them stand on the mean level. One that is alike, but for sun
    and darkness, lends its light.
    """
    level_sea = replace(sea, waves=None, tide=None)
    water = components.expected_water(scenario)
    engine = _engine(scenario, _unreachable_bottom(scenario), water, level_sea)
    pose = Pose(
        position=np.array([0.0, 0.0, frame.measured.position[2]]),
        roll=0.0,
        pitch=0.0,
        heading=frame.measured.heading,
    )
    if alike is None:
        light, surface, variance = _mean_flash(engine, pose)
        column = light - surface
    else:
        surface, column, variance = alike.surface, alike.column, alike.variance
    radiance = components.background_radiance(scenario)
    build = partial(noise_model, scenario, steady_light(scenario, radiance))
    level = build(surface + column, variance)
    return PosedNoise(
        level=replace(level, surface_walk=surface_walk(level)),
        pose=pose,
        camera=engine.camera,
        water_level=engine.surface.level,
        surface=surface,
        column=column,
        variance=variance,
        build=build,
    )


def _expected_errors(
    scenario: Scenario, noise: PosedNoise, sea: SeaSurface, alike: Mission | None
) -> Callable[[], Scattering]:
    """Return what makes the table of scattering; it depends on the sun, for the search does."""
    if alike and alike.noise.steady_light == noise.level.steady_light:
        return alike.scattering
    return _once(partial(_scattering, scenario, noise, sea))


def _scattering(scenario: Scenario, noise: PosedNoise, sea: SeaSurface) -> Scattering:
    """Return what scattered light is expected to do to the bottom; nothing if it may stay."""
    if not scenario.processing.correct_scattering:
        return Scattering.none()
    water, level_sea = components.expected_water(scenario), replace(sea, waves=None, tide=None)
    return LevelBottoms(
        engine=lambda bed: _engine(scenario, bed, water, level_sea),
        search=SEARCHES[scenario.processing.ranging],
        noise=noise.level,
        frame=Frame(index=0, line=0, time=0.0, pose=noise.pose),
        camera=noise.camera,
        level=sea.level,
        map_frame=components.map_frame(scenario),
    ).expected_errors()


def _once(make: Callable[[], Scattering]) -> Callable[[], Scattering]:
    """Return a function that makes a table when first asked; other threads wait for it."""
    lock, made = Lock(), cache(make)

    def get() -> Scattering:
        with lock:
            return made()

    return get


def _wave_statistics(sea: SeaSurface, *, pixel: float) -> WaveStatistics:
    """Return the waves' spectrum; one patch stands for what a log or a forecast would tell."""
    if sea.waves is None:
        return WaveStatistics.still(pixel)
    half = 0.5 * WAVE_PATCH
    patch = sea.waves.lattice(time=0.0, level=0.0, west=-half, east=half, south=-half, north=half)
    side = min(patch.coefficients.shape)
    return WaveStatistics.of_elevations(
        patch.coefficients[:side, :side], spacing=1.0 / patch.per_cell, pixel=pixel
    )


def noise_model(
    scenario: Scenario, steady: float, light: FloatArray, variance: FloatArray
) -> NoiseModel:
    """Return the noise model of expected light without a bottom (rows, columns, bins).

    ``steady`` is that of sun and darkness in a bin, ``variance`` the squared Monte Carlo error of
    the light in one flash.
    """
    receiver, detector = components.receiver(scenario), components.detector(scenario)
    sigma = _seen_pulse(scenario)
    pad = int(np.ceil(3.0 * sigma / receiver.bin_width))
    return NoiseModel.build(
        settings=components.ranging_settings(scenario),
        detector=detector,
        steady_light=steady,
        bottomless_light=light + steady,
        flash_variance=variance,
        model_flashes=MODEL_FLASHES,
        pulse=pulse_taps(sigma=sigma, width=receiver.bin_width, pad=pad),
        bin_start=receiver.gate_start,
        bin_width=receiver.bin_width,
    )


def _calibration(scenario: Scenario, frame: Frame, sea: SeaSurface) -> Calibration:
    """Return what makes reflectances of counts, by the water and the level that are expected."""
    height = frame.measured.position[2] - sea.level - scenario.processing.water_level_error_m
    light = expected_light(scenario, height=height, water=components.expected_water(scenario))
    bottomless = light.column() + light.surface_echo()
    steady = steady_light(scenario, components.background_radiance(scenario))
    noise = noise_model(coarse(scenario), steady, bottomless, np.zeros_like(bottomless))
    deepest = max(light.gate_depth, 2.0 * SHALLOWEST_CALIBRATED)
    depths = np.geomspace(SHALLOWEST_CALIBRATED, deepest, CALIBRATED_DEPTHS)
    return Calibration.expected(light, noise, depths=depths.tolist())


def _seen_pulse(scenario: Scenario) -> float:
    """Return the standard deviation of the pulse as the detector sees it [s]."""
    return hypot(components.laser(scenario).pulse_sigma, components.detector(scenario).timing_sigma)


def _mean_flash(engine: Engine, pose: Pose) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return mean photo-electrons, those of the surface, and mean squared error of a flash."""
    shape = (*engine.camera.shape, engine.receiver.bins)
    light, surface, variance = np.zeros(shape), np.zeros(shape), np.zeros(shape)
    for flash in _model_flashes(engine, pose):
        light += flash.total / MODEL_FLASHES
        surface += flash.origin("surface") / MODEL_FLASHES
        variance += flash.variance.sum(axis=0) / MODEL_FLASHES
    return light, surface, variance


def _model_flashes(engine: Engine, pose: Pose) -> Iterator[Waveforms]:
    """Yield the model's flashes in their order; no more are held than fly abreast."""
    last = FIRST_MODEL_FRAME + MODEL_FLASHES
    with ThreadPoolExecutor(ABREAST) as crew:
        for number in range(FIRST_MODEL_FRAME, last, ABREAST):
            some = range(number, min(number + ABREAST, last))
            yield from crew.map(lambda frame: engine.flash(pose=pose, frame=frame), some)


def _engine(scenario: Scenario, seabed: Seabed, water: WaterColumn, surface: SeaSurface) -> Engine:
    receiver = components.receiver(scenario)
    efficiency = components.detector(scenario).photo_electrons_per_photon
    return Engine(
        seabed=seabed,
        surface=surface,
        water=water,
        laser=components.laser(scenario),
        camera=components.camera(scenario),
        receiver=receiver,
        photo_electrons_per_photon=receiver.optics_transmission * efficiency,
        settings=components.transport_settings(scenario),
        seed=scenario.mission.seed,
    )


def steady_light(scenario: Scenario, radiance: float) -> float:
    """Return photo-electrons of sun and darkness in a bin of a pixel [1], equations (1), (8).

    Parameters
    ----------
    scenario : Scenario
    radiance : float
        Of the background [W / (m2 m sr)].
    """
    receiver, detector = components.receiver(scenario), components.detector(scenario)
    power = background_power(
        radiance=radiance,
        filter_width=receiver.filter_width,
        aperture_area=receiver.aperture_area,
        solid_angle=components.camera(scenario).pixel_tangent ** 2,
    )
    photons = power * receiver.optics_transmission / components.laser(scenario).photon_energy
    rate = photons * detector.photo_electrons_per_photon + detector.dark_count_rate
    return rate * receiver.bin_width


def _unreachable_bottom(scenario: Scenario) -> Seabed:
    """Return a small plane deeper than any light of the gate."""
    frame = components.map_frame(scenario)
    level = scenario.surface.water_level_m
    ground = Ground(map_frame=frame, length=10.0, width=10.0, reflectance=0.0)
    return plane(ground=ground, depth=1000.0 - level)
