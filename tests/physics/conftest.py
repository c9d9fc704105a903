"""A flash over made scenes, the instrument being the paper's."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from survey.flight.pose import Pose
from survey.optics.phase import PhaseFunction
from survey.optics.water import WaterColumn, petzold_water
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.engine import Engine
from survey.transport.settings import TransportSettings
from terrain.generators import Ground, slope
from terrain.map_frame import MapFrame
from terrain.sea_surface import SeaSurface
from terrain.seabed import Seabed

FRAME = MapFrame(easting=500000.0, northing=6.0e6, epsg=25832, vertical_epsg=5714)


def make_engine(
    *,
    depth: float = 10.0,
    gradient: float = 0.0,
    reflectance: float = 0.1,
    water: str = "coastal",
    absorption: float | None = None,
    scattering: float | None = None,
    index: float = 1.33,
    group_index: float | None = None,
    wind_speed: float = 5.0,
    surface: SeaSurface | None = None,
    pulse_fwhm: float = 10e-9,
    pulse_energy: float = 1.0,
    aperture_radius: float = 0.005,
    scale: float = 1.0,
    gate_start: float = 1.3e-6,
    bins: int = 300,
    shape: tuple[int, int] = (32, 64),
    pixel_tangent: float = 0.008,
    seabed: Seabed | None = None,
    phase_function: PhaseFunction | None = None,
    column: WaterColumn | None = None,
    seed: int = 1,
    **settings: Any,
) -> Engine:
    """Return an engine, over a plane seabed by default; ``scale`` stretches lengths and times."""
    ground = Ground(
        map_frame=FRAME,
        length=800.0 * scale,
        width=800.0 * scale,
        axis=np.pi / 2,
        reflectance=reflectance,
    )
    return Engine(
        seabed=slope(ground=ground, depth=depth * scale, gradient=gradient)
        if seabed is None
        else seabed,
        surface=SeaSurface.from_wind(level=0.0, wind_speed=wind_speed, wind_from=0.0)
        if surface is None
        else surface,
        water=petzold_water(
            water,
            refractive_index=index,
            group_index=index if group_index is None else group_index,
            absorption=absorption,
            scattering=scattering,
            phase_function=phase_function,
        )
        if column is None
        else column,
        laser=Laser(pulse_energy=pulse_energy, wavelength=532e-9, pulse_fwhm=pulse_fwhm * scale),
        camera=Camera(
            rows=shape[0], columns=shape[1], pixel_tangent=pixel_tangent, long_side="along"
        ),
        receiver=Receiver(
            aperture_radius=aperture_radius * scale,
            filter_width=1e-9,
            optics_transmission=1.0,
            gate_start=gate_start * scale,
            bin_width=1e-9 * scale,
            bins=bins,
        ),
        photo_electrons_per_photon=0.2,
        settings=TransportSettings(**settings),
        seed=seed,
    )


def level_pose(*, height: float = 200.0, heading: float = 0.0) -> Pose:
    """Return a level pose over the origin."""
    return Pose(position=np.array([0.0, 0.0, height]), roll=0.0, pitch=0.0, heading=heading)


@pytest.fixture
def engine_of() -> Any:
    """Give the maker of engines."""
    return make_engine


@pytest.fixture
def nadir() -> Pose:
    """Give a level pose 200 m over the water."""
    return level_pose()
