"""From a scenario to the parts of a mission: here and in `*_parts` units are converted.

Every function returns a part in SI units and radians. The parts are imported when they are built,
so that checking a scenario stays quick.
"""

from __future__ import annotations

from math import floor, radians
from typing import TYPE_CHECKING

from survey.errors import UserError
from survey.scenario.flight_sections import LinesFlight
from survey.scenario.scenario import Scenario
from survey.scenario.sun import (
    air_extinction_per_m,
    stated_irradiance_w_m2_nm,
    water_reflectance,
)
from survey.scenario.times import gate_start_ns
from survey.scenario.water_sections import WaterSection

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from survey.cloud.noise import RangingSettings
    from survey.flight.navigation import Navigation
    from survey.flight.pose import Frame
    from survey.flight.trajectory import Plan
    from survey.optics.background import CoxMunkGlint, Sky
    from survey.optics.water import WaterColumn
    from survey.sensor.camera import Camera
    from survey.sensor.detector import Detector
    from survey.sensor.laser import Laser
    from survey.sensor.receiver import Receiver
    from survey.transport.settings import TransportSettings
    from terrain.map_frame import MapFrame
    from terrain.sea_surface import SeaSurface
    from terrain.seabed import Seabed

    FloatArray = NDArray[np.float64]

NANO = 1e-9
MICRO = 1e-6
ORIGIN_STEP_M = 1000.0
NIGHT_RADIANCE_W_M2_UM_SR = 1e-3  # [Lisenko2017], night without a moon


def map_frame(scenario: Scenario) -> MapFrame:
    """Return the local frame: its origin is the flight's start, rounded down to a kilometre."""
    from survey.scenario.flight_parts import start_on_map
    from terrain.map_frame import MapFrame

    mission = scenario.mission
    east, north = start_on_map(scenario.flight, epsg=mission.crs_epsg, folder=scenario.folder)
    return MapFrame(
        easting=floor(east / ORIGIN_STEP_M) * ORIGIN_STEP_M,
        northing=floor(north / ORIGIN_STEP_M) * ORIGIN_STEP_M,
        epsg=mission.crs_epsg,
        vertical_epsg=mission.vertical_epsg,
    )


def laser(scenario: Scenario) -> Laser:
    """Return the laser."""
    from survey.sensor.laser import Laser

    given = scenario.laser
    return Laser(
        pulse_energy=given.pulse_energy_j,
        wavelength=given.wavelength_nm * NANO,
        pulse_fwhm=given.pulse_width_ns * NANO,
    )


def camera(scenario: Scenario) -> Camera:
    """Return the camera."""
    from survey.sensor.camera import Camera

    given = scenario.camera
    return Camera(
        rows=given.rows,
        columns=given.columns,
        pixel_tangent=given.pixel_footprint_m / given.design_range_m,
        long_side=given.long_side,
    )


def receiver(scenario: Scenario) -> Receiver:
    """Return the receiving optics with their gate, counted from the pulse's departure."""
    from survey.sensor.receiver import Receiver

    given = scenario.receiver
    return Receiver(
        aperture_radius=given.aperture_radius_m,
        filter_width=given.filter_width_nm * NANO,
        optics_transmission=given.optics_transmission,
        gate_start=gate_start_ns(given, scenario.flight) * NANO,
        bin_width=given.bin_width_ns * NANO,
        bins=given.bins,
    )


def detector(scenario: Scenario) -> Detector:
    """Return the detector behind every pixel."""
    from survey.scenario.detector_parts import build_detector

    return build_detector(scenario)


def water(scenario: Scenario) -> WaterColumn:
    """Return the water with its layers."""
    return _column(scenario, scenario.water)


def expected_water(scenario: Scenario) -> WaterColumn:
    """Return the water that thresholds are made for: with its layers, or without."""
    if scenario.processing.expects_layers:
        return water(scenario)
    return _column(scenario, scenario.water.model_copy(update={"layers": []}))


def _column(scenario: Scenario, given: WaterSection) -> WaterColumn:
    from survey.scenario.water_column_parts import build_column

    return build_column(given, wavelength_nm=scenario.laser.wavelength_nm, folder=scenario.folder)


def sea_surface(scenario: Scenario) -> SeaSurface:
    """Return the sea surface with its waves."""
    from survey.scenario.surface_parts import build_sea

    return build_sea(scenario.surface, seed=scenario.mission.seed)


def sky(scenario: Scenario) -> Sky:
    """Return the sun, the air above the sea, and how the sea sends their light up."""
    from survey.optics.background import Sky

    given, flight = scenario.sun, scenario.flight
    layered = given.model == "layered"
    extinction = air_extinction_per_m(given, flight) if layered else 0.0
    return Sky(
        zenith=radians(given.zenith_deg),
        wind_speed=scenario.surface.wind_speed_m_s,
        optical_thickness=given.optical_thickness,
        solar_irradiance=_solar_irradiance(scenario),
        legendre_moment=given.legendre_moment,
        water_reflectance=water_reflectance(given, scenario.water),
        model=given.model,
        layer_thickness=min(extinction * flight.height_m, given.optical_thickness),
        glint=_glint(scenario) if given.glint == "cox_munk" else None,
    )


def _solar_irradiance(scenario: Scenario) -> float:
    """Return the spectral solar constant, as stated or the mean over the filter [W/m3]."""
    if scenario.sun.spectrum == "stated":
        return stated_irradiance_w_m2_nm(scenario.sun) / NANO
    from survey.optics.solar_spectrum import mean_solar_irradiance

    return mean_solar_irradiance(
        wavelength=laser(scenario).wavelength, width=receiver(scenario).filter_width
    )


def _glint(scenario: Scenario) -> CoxMunkGlint:
    """Return the sea's glint by measured slopes."""
    from survey.optics.background import CoxMunkGlint

    return CoxMunkGlint(
        sea=sea_surface(scenario),
        sun_azimuth=radians(scenario.sun.azimuth_deg),
        refractive_index=scenario.water.refractive_index,
    )


def background_radiance(scenario: Scenario) -> float:
    """Return the spectral radiance of the background [W / (m2 m sr)].

    The stated one if there is one; by day that of `sky`; by night that of a night without a moon.
    """
    given = scenario.sun
    if given.radiance_w_m2_um_sr is not None:
        return given.radiance_w_m2_um_sr / MICRO
    return sky(scenario).radiance() if given.day else NIGHT_RADIANCE_W_M2_UM_SR / MICRO


def flight_plan(scenario: Scenario) -> Plan:
    """Return the flight plan in the local frame."""
    from survey.scenario.flight_parts import build_plan

    frame = map_frame(scenario)
    return build_plan(
        scenario.flight,
        view=camera(scenario).half_tangents,
        water_level_m=scenario.surface.water_level_m,
        origin=(frame.easting, frame.northing),
        epsg=frame.epsg,
        folder=scenario.folder,
    )


def flight_size(scenario: Scenario) -> str:
    """Return how many lines and frames a flight has, in words."""
    flight = scenario.flight
    if isinstance(flight, LinesFlight):
        return f"lines x frames: {flight.lines} x {flight.frames_per_line}"
    plan = flight_plan(scenario)
    return f"lines: {plan.line_count}, frames: {plan.frame_count}"


def frames(scenario: Scenario) -> list[Frame]:
    """Return every flash with the sensor's true pose and the one that navigation says."""
    from survey.flight.motion import CHANNELS, moved
    from survey.flight.navigation import QUANTITIES, navigated
    from survey.flight.trajectory import fly_lines
    from survey.scenario.motion_parts import build_motion
    from survey.transport.random import MOTION, NAVIGATION, chance

    seed = scenario.mission.seed
    motions = [chance(seed=seed, purpose=MOTION, frame=i) for i in range(len(CHANNELS))]
    errors = [chance(seed=seed, purpose=NAVIGATION, frame=i) for i in range(len(QUANTITIES))]
    flown = moved(fly_lines(flight_plan(scenario)), build_motion(scenario.motion), motions)
    return navigated(flown, navigation(scenario), errors)


def navigation(scenario: Scenario) -> Navigation:
    """Return the errors of navigation and the sensor's mounting."""
    from survey.scenario.motion_parts import build_navigation

    return build_navigation(scenario.navigation)


def survey_area(scenario: Scenario) -> FloatArray | None:
    """Return the ring (n, 2) of the ordered area in the local frame [m]; None without one."""
    return getattr(flight_plan(scenario), "polygon", None)


def transport_settings(scenario: Scenario) -> TransportSettings:
    """Return the work and the resolution of the Monte Carlo."""
    from survey.transport.settings import TransportSettings

    given = scenario.transport
    return TransportSettings(
        walks_per_pixel=given.walks_per_pixel,
        replicates=given.replicates,
        tracks_per_replicate=given.tracks_per_replicate,
        split_angle=radians(given.split_angle_deg),
        column_spacing=given.column_spacing,
        illumination=scenario.laser.illumination,
    )


def ranging_settings(scenario: Scenario) -> RangingSettings:
    """Return how echoes are found in the counts."""
    from survey.cloud.noise import RangingSettings

    given = scenario.processing
    width_ns = scenario.laser.pulse_width_ns if given.echo_gate_ns is None else given.echo_gate_ns
    return RangingSettings(false_alarm_rate=given.false_alarm_rate, gate=width_ns * NANO)


def view_outlines(scenario: Scenario) -> list[FloatArray]:
    """Return what the frames see of the lowest water: outlines (corners, 2) in the local frame [m].

    Raises
    ------
    UserError
        Naming frames that see no water.
    """
    from survey.flight.trajectory import footprints

    try:
        lowest = scenario.surface.water_level_m - scenario.surface.tidal_amplitude_m
        return footprints(camera(scenario), frames(scenario), lowest)
    except ValueError as fault:
        raise _named(scenario, fault) from fault


def seabed(scenario: Scenario) -> Seabed:
    """Return the seabed with the objects on it.

    Raises
    ------
    FileNotFoundError, SeabedFileError
        When a file is not there or cannot be used.
    UserError
        When the parts do not fit.
    """
    from survey.scenario.seabed_objects import with_objects
    from survey.scenario.seabed_parts import bare_seabed
    from terrain.file_faults import SeabedFileError

    frame, outlines = map_frame(scenario), view_outlines(scenario)
    try:
        return with_objects(bare_seabed(scenario, frame, outlines), scenario, frame)
    except SeabedFileError:
        raise
    except ValueError as fault:
        raise _named(scenario, fault) from fault


def _named(scenario: Scenario, fault: ValueError) -> UserError:
    """Return a fault with the scenario's name before every line."""
    return UserError("\n".join(f"{scenario.name}: {line}" for line in str(fault).splitlines()))
