"""From a scenario to the parts of its mission, built once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.ranging import NoiseModel
from survey.flight.pose import Frame, Pose
from survey.flight.trajectory import fly_lines, footprint
from survey.optics.background import background_power
from survey.products.run_products import ProductSettings
from survey.scenario import components
from survey.scenario.scenario import Scenario
from survey.sensor.camera import Camera
from survey.sensor.detector import IdealCounter
from survey.transport.engine import Engine
from survey.transport.waveforms import pulse_taps
from terrain.generators import Ground, plane
from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]

MODEL_FLASHES = 4
FIRST_MODEL_FRAME = 1 << 31


@dataclass(frozen=True, kw_only=True)
class Mission:
    """The parts of a mission in SI units; `prepare` builds them."""

    frames: Sequence[Frame]
    camera: Camera
    detector: IdealCounter
    seabed: Seabed
    engine: Engine
    noise: NoiseModel
    products: ProductSettings


def prepare(scenario: Scenario) -> Mission:
    """Build seabed, flight, engine and noise model, and refuse a flight that leaves the seabed.

    Raises
    ------
    ValueError
        With every fault, each in a line of its own.
    """
    camera, surface = components.camera(scenario), components.sea_surface(scenario)
    frames = fly_lines(components.flight_plan(scenario))
    seabed = components.seabed(scenario)
    seabed.require_coverage([footprint(camera, frame.pose, surface.level) for frame in frames])
    return Mission(
        frames=frames,
        camera=camera,
        detector=components.detector(scenario),
        seabed=seabed,
        engine=_engine(scenario, seabed),
        noise=noise_model(scenario, frames[0]),
        products=ProductSettings(
            title=scenario.mission.title,
            description=scenario.mission.description,
            start_utc=scenario.mission.start_utc,
            water_level=surface.level,
            thinning=scenario.processing.thinning_m,
            grid=scenario.processing.grid_m,
            pixel_spacing=camera.pixel_tangent * scenario.flight.height_m,
        ),
    )


def noise_model(scenario: Scenario, frame: Frame) -> NoiseModel:
    """Return what a flash counts over water without a bottom, and the thresholds above it.

    The expected column is that of the scenario's water, from flashes of its own over a bottom that
    nothing can reach; a survey would know it from its deep water.
    """
    receiver, laser = components.receiver(scenario), components.laser(scenario)
    engine = _engine(scenario, _unreachable_bottom(scenario))
    pose = Pose(
        position=np.array([0.0, 0.0, frame.pose.position[2]]),
        roll=0.0,
        pitch=0.0,
        heading=frame.pose.heading,
    )
    light, variance = _mean_flash(engine, pose)
    steady = _steady_counts(scenario)
    pad = int(np.ceil(3.0 * laser.pulse_sigma / receiver.bin_width))
    return NoiseModel.build(
        settings=components.ranging_settings(scenario),
        steady=steady,
        bottomless=light + steady,
        flash_variance=variance,
        model_flashes=MODEL_FLASHES,
        pulse=pulse_taps(sigma=laser.pulse_sigma, width=receiver.bin_width, pad=pad),
        bin_start=receiver.gate_start,
        bin_width=receiver.bin_width,
    )


def _mean_flash(engine: Engine, pose: Pose) -> tuple[FloatArray, FloatArray]:
    """Return mean photo-electrons and mean squared error of the model's flashes, one at a time."""
    shape = (*engine.camera.shape, engine.receiver.bins)
    light, variance = np.zeros(shape), np.zeros(shape)
    for number in range(MODEL_FLASHES):
        flash = engine.flash(pose=pose, frame=FIRST_MODEL_FRAME + number)
        light += flash.total / MODEL_FLASHES
        variance += flash.variance.sum(axis=0) / MODEL_FLASHES
    return light, variance


def _engine(scenario: Scenario, seabed: Seabed) -> Engine:
    receiver = components.receiver(scenario)
    efficiency = components.detector(scenario).quantum_efficiency
    return Engine(
        seabed=seabed,
        surface=components.sea_surface(scenario),
        water=components.water(scenario),
        laser=components.laser(scenario),
        camera=components.camera(scenario),
        receiver=receiver,
        photo_electrons_per_photon=receiver.optics_transmission * efficiency,
        settings=components.transport_settings(scenario),
        seed=scenario.mission.seed,
    )


def _steady_counts(scenario: Scenario) -> float:
    """Return sun and dark counts of a pixel in one bin [1], equations (1) and (8)."""
    receiver, detector = components.receiver(scenario), components.detector(scenario)
    power = background_power(
        radiance=components.background_radiance(scenario),
        filter_width=receiver.filter_width,
        aperture_area=receiver.aperture_area,
        solid_angle=components.camera(scenario).pixel_tangent ** 2,
    )
    photons = power * receiver.optics_transmission / components.laser(scenario).photon_energy
    rate = photons * detector.quantum_efficiency + detector.dark_count_rate
    return rate * receiver.bin_width


def _unreachable_bottom(scenario: Scenario) -> Seabed:
    """Return a small plane deeper than any light of the gate."""
    frame = components.map_frame(scenario)
    level = scenario.surface.water_level_m
    ground = Ground(map_frame=frame, length=10.0, width=10.0, reflectance=0.0)
    return plane(ground=ground, depth=1000.0 - level)
