"""From a scenario to the parts of a mission: here and in `seabed_parts` units are converted.

Every function returns a part in SI units and radians. The parts are imported when they are built,
so that checking a scenario stays quick.
"""

from __future__ import annotations

from math import floor, radians
from typing import TYPE_CHECKING

from survey.errors import UserError
from survey.scenario.rules import gate_start_ns
from survey.scenario.scenario import Scenario

if TYPE_CHECKING:
    from survey.cloud.ranging import RangingSettings
    from survey.flight.plan import FlightPlan
    from survey.optics.background import Sky
    from survey.optics.water import Water
    from survey.sensor.camera import Camera
    from survey.sensor.detector import IdealCounter
    from survey.sensor.laser import Laser
    from survey.sensor.receiver import Receiver
    from survey.transport.settings import TransportSettings
    from terrain.map_frame import MapFrame
    from terrain.sea_surface import SeaSurface
    from terrain.seabed import Seabed

NANO = 1e-9
MICRO = 1e-6
ORIGIN_STEP_M = 1000.0
NIGHT_RADIANCE_W_M2_UM_SR = 1e-3  # [Lisenko2017], night without a moon


def map_frame(scenario: Scenario) -> MapFrame:
    """Return the local frame: its origin is the flight's start, rounded down to a kilometre."""
    from terrain.map_frame import MapFrame

    flight, mission = scenario.flight, scenario.mission
    return MapFrame(
        easting=floor(flight.start_easting_m / ORIGIN_STEP_M) * ORIGIN_STEP_M,
        northing=floor(flight.start_northing_m / ORIGIN_STEP_M) * ORIGIN_STEP_M,
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


def detector(scenario: Scenario) -> IdealCounter:
    """Return the photon counter behind every pixel."""
    from survey.sensor.detector import IdealCounter

    given = scenario.detector
    return IdealCounter(
        quantum_efficiency=given.quantum_efficiency,
        dark_count_rate=given.dark_count_rate_hz,
        max_counts_per_bin=given.max_counts_per_bin,
    )


def water(scenario: Scenario) -> Water:
    """Return the water."""
    from survey.optics.water import petzold_water

    given = scenario.water
    return petzold_water(
        given.type,
        absorption=given.absorption_per_m,
        scattering=given.scattering_per_m,
        refractive_index=given.refractive_index,
        group_index=given.group_index,
    )


def sea_surface(scenario: Scenario) -> SeaSurface:
    """Return the sea surface that the wind makes."""
    from terrain.sea_surface import SeaSurface

    given = scenario.surface
    return SeaSurface.from_wind(
        level=given.water_level_m,
        wind_speed=given.wind_speed_m_s,
        wind_from=radians(given.wind_from_deg),
        correlation_length=given.slope_correlation_length_m,
    )


def sky(scenario: Scenario) -> Sky:
    """Return the sun and the air above the sea."""
    from survey.optics.background import Sky

    given = scenario.sun
    return Sky(
        zenith=radians(given.zenith_deg),
        wind_speed=scenario.surface.wind_speed_m_s,
        optical_thickness=given.optical_thickness,
        solar_irradiance=given.solar_irradiance_w_m2_nm / NANO,
        legendre_moment=given.legendre_moment,
        water_reflectance=given.water_reflectance,
    )


def background_radiance(scenario: Scenario) -> float:
    """Return the spectral radiance of the background [W / (m2 m sr)].

    The stated one if there is one; by day that of `sky`; by night that of a night without a moon.
    """
    given = scenario.sun
    if given.radiance_w_m2_um_sr is not None:
        return given.radiance_w_m2_um_sr / MICRO
    return sky(scenario).radiance() if given.day else NIGHT_RADIANCE_W_M2_UM_SR / MICRO


def flight_plan(scenario: Scenario) -> FlightPlan:
    """Return the flight plan in the local frame."""
    from survey.flight.plan import FlightPlan

    given, frame = scenario.flight, map_frame(scenario)
    return FlightPlan(
        start=(given.start_easting_m - frame.easting, given.start_northing_m - frame.northing),
        heading=radians(given.heading_deg),
        height=given.height_m,
        water_level=scenario.surface.water_level_m,
        speed=given.speed_m_s,
        flash_rate=given.flash_rate_hz,
        frames_per_line=given.frames_per_line,
        lines=given.lines,
        swath=2.0 * camera(scenario).half_tangents[1] * given.height_m,
        sidelap=given.sidelap,
        turn=given.turn,
        turn_time=given.turn_time_s,
    )


def transport_settings(scenario: Scenario) -> TransportSettings:
    """Return the work and the resolution of the Monte Carlo."""
    from survey.transport.settings import TransportSettings

    given = scenario.transport
    return TransportSettings(
        forward_walks_per_m2=given.forward_walks_per_m2,
        backward_walks_per_pixel=given.backward_walks_per_pixel,
        replicates=given.replicates,
        split_angle=radians(given.split_angle_deg),
        patch_size=given.patch_size_m,
        layer_thickness=given.layer_thickness_m,
        cell_size=given.cell_size_m,
        illumination=scenario.laser.illumination,
    )


def ranging_settings(scenario: Scenario) -> RangingSettings:
    """Return how echoes are found in the counts."""
    from survey.cloud.ranging import RangingSettings

    given = scenario.processing
    width_ns = scenario.laser.pulse_width_ns if given.echo_gate_ns is None else given.echo_gate_ns
    return RangingSettings(false_alarm_rate=given.false_alarm_rate, gate=width_ns * NANO)


def seabed(scenario: Scenario) -> Seabed:
    """Return the seabed with the objects on it.

    Raises
    ------
    FileNotFoundError, SeabedFileError
        When a file is not there or cannot be used.
    UserError
        When the parts do not fit.
    """
    from survey.flight.trajectory import fly_lines, footprint
    from survey.scenario.seabed_parts import bare_seabed, with_objects
    from terrain.file_faults import SeabedFileError

    frame = map_frame(scenario)
    outlines = [
        footprint(camera(scenario), flash.pose, scenario.surface.water_level_m)
        for flash in fly_lines(flight_plan(scenario))
    ]
    try:
        return with_objects(bare_seabed(scenario, frame, outlines), scenario, frame)
    except SeabedFileError:
        raise
    except ValueError as fault:
        lines = [f"{scenario.name}: {line}" for line in str(fault).splitlines()]
        raise UserError("\n".join(lines)) from fault
