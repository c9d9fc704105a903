"""From which distance the laser's flood is safe to look into, by IEC 60825-1.

Limits are those of IEC 60825-1:2014, tables A.1 and 9, for 400 to 700 nm and a point source
(C6 = 1), averaged over a pupil of 7 mm. The standard itself was not seen: its numbers were read in
two public programs that carry them, and both agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, sqrt

from survey.sensor.camera import Camera
from survey.sensor.laser import Laser

SOURCE = "IEC 60825-1:2014, tables A.1 and 9, as two public programs carry them; C6 = 1"
SHORTEST, THERMAL = 1e-11, 5e-6  # between them the limit is constant [s]
PULSE_LIMIT, SHORTEST_LIMIT = 2e-3, 1e-3  # [J/m2]
LONGEST = 10.0  # from where on the limit is one of power [s]
BLINK = 0.25  # [s]
FEW_PULSES = 600
BINOCULARS = "7 x 50"
BINOCULAR_GAIN = 49.0  # assumed: magnification squared, nothing lost in the glass


@dataclass(frozen=True, kw_only=True)
class EyeSafety:
    """What the beam does to an eye in it, by one pulse of the train.

    Parameters
    ----------
    limit : float
        Highest radiant exposure by one pulse [J/m2].
    pulses : int
        Pulses that somebody in one place gets while the aircraft passes.
    at_water : float
        Radiant exposure by one pulse at the water, in the view's corner [J/m2].
    distance, binocular_distance : float
        Nominal ocular hazard distance below the aircraft, for the naked eye and through
        `BINOCULARS` [m].
    """

    limit: float
    pulses: int
    at_water: float
    distance: float
    binocular_distance: float


def exposure_limit(duration: float) -> float:
    """Highest radiant exposure of an eye by one exposure, 400 to 700 nm, C6 = 1 [J/m2].

    IEC 60825-1:2014, table A.1: 1e-3 below 1e-11 s, 2e-3 up to 5e-6 s, then 18 t^0.75.

    Parameters
    ----------
    duration : float
        t, at most 10 s [s].

    Examples
    --------
    >>> exposure_limit(10e-9), round(exposure_limit(0.25), 2)
    (0.002, 6.36)
    """
    if duration < SHORTEST:
        return SHORTEST_LIMIT
    return PULSE_LIMIT if duration <= THERMAL else 18.0 * min(duration, LONGEST) ** 0.75


def train_factor(*, pulses: float, duration: float) -> float:
    """C5 for pulses of at most 5 us: how much lower the limit is for each of many [1].

    IEC 60825-1:2014, table 9: 1 up to 0.25 s or 600 pulses, then 5 N^-0.25, but not below 0.4.

    Examples
    --------
    >>> train_factor(pulses=600, duration=10.0), train_factor(pulses=10000, duration=10.0)
    (1.0, 0.5)
    """
    if duration <= BLINK or pulses <= FEW_PULSES:
        return 1.0
    return float(max(5.0 * pulses**-0.25, 0.4))


def pulse_limit(
    *, pulse_duration: float, burst: int, burst_rate: float, flashes: int, dwell: float
) -> float:
    """Highest radiant exposure by each pulse of all that an eye gets [J/m2].

    The strictest of: the single pulse, pulses within 5 us counting as one, with C5; and the
    exposure of a whole burst, and of the whole passage, shared out among their pulses.

    Parameters
    ----------
    pulse_duration : float
        [s].
    burst : int
        Pulses of a flash.
    burst_rate : float
        At which they follow each other [1/s].
    flashes : int
        In which the eye lies in the beam.
    dwell : float
        How long it does [s].

    Examples
    --------
    >>> pulse_limit(pulse_duration=10e-9, burst=1, burst_rate=1e5, flashes=2, dwell=1.0)
    0.002
    >>> round(pulse_limit(pulse_duration=1e-9, burst=100, burst_rate=1e5, flashes=2, dwell=1.0), 5)
    0.001
    """
    exposure = min(dwell, LONGEST)
    at_once = min(burst, 1 + int(THERMAL * burst_rate))
    single = exposure_limit(pulse_duration if at_once == 1 else THERMAL)
    factor = train_factor(pulses=flashes * burst / at_once, duration=exposure)
    length = (burst - 1) / burst_rate + pulse_duration
    return min(
        factor * single / at_once,
        exposure_limit(length) / burst,
        exposure_limit(max(exposure, length)) / (flashes * burst),
    )


def eye_safety(
    *,
    laser: Laser,
    camera: Camera,
    height: float,
    speed: float,
    flash_rate: float,
    burst: int,
    burst_rate: float,
) -> EyeSafety:
    """Return what the flood does to an eye that looks up into it from the view's corner.

    The pulse fills the field of view evenly in its tangent plane: H = Q / (F R^2 cos t) at R below
    the sensor, F the field in tangents, t the corner's angle. No air, no waves that focus, no exit
    optics of finite size; nobody blinks.

    Parameters
    ----------
    laser, camera : Laser, Camera
    height : float
        Above the water [m].
    speed, flash_rate : float
        [m/s], [1/s].
    burst : int
        Pulses of a flash.
    burst_rate : float
        [1/s].

    Examples
    --------
    >>> found = eye_safety(
    ...     laser=Laser(pulse_energy=1.0, wavelength=532e-9, pulse_fwhm=10e-9),
    ...     camera=Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along"),
    ...     height=200.0, speed=100.0, flash_rate=1.0, burst=1, burst_rate=1e5)
    >>> round(found.distance), round(found.binocular_distance), found.pulses
    (63, 441, 2)
    """
    forward, right = camera.half_tangents
    dwell = 2.0 * forward * height / speed
    flashes = 1 + int(min(dwell, LONGEST) * flash_rate)
    limit = pulse_limit(
        pulse_duration=laser.pulse_fwhm,
        burst=burst,
        burst_rate=burst_rate,
        flashes=flashes,
        dwell=dwell,
    )
    spread = 4.0 * forward * right / hypot(1.0, forward, right)
    distance = sqrt(laser.pulse_energy / (spread * limit))
    return EyeSafety(
        limit=limit,
        pulses=flashes * burst,
        at_water=laser.pulse_energy / (spread * height**2),
        distance=distance,
        binocular_distance=distance * sqrt(BINOCULAR_GAIN),
    )
