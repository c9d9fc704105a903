"""The sections of a scenario file: their keys, units, defaults and bounds."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from pydantic import AwareDatetime, BaseModel, ConfigDict, Field, field_validator
from pydantic_core import PydanticCustomError

from terrain.extent import FARTHEST, HIGHEST

LEAST_SIZE, LARGEST_SIZE = 1e-15, 1e12
"""Of any number but 0 in a scenario: products and quotients of such numbers stay finite."""
Positive = Annotated[float, Field(gt=0.0)]
NotNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(gt=0.0, le=1.0)]
Count = Annotated[int, Field(ge=1, le=2**31 - 1)]
Height = Annotated[float, Field(gt=0.0, le=20_000.0)]
Elevation = Annotated[float, Field(ge=-HIGHEST, le=HIGHEST)]
Coordinate = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]
Bearing = Annotated[float, Field(ge=0.0, lt=360.0)]
Text = Annotated[str, Field(min_length=1)]


class Section(BaseModel):
    """One section; any may name where its numbers come from (``source = "assumed"``)."""

    model_config = ConfigDict(
        extra="forbid", strict=True, frozen=True, allow_inf_nan=False, validate_default=True
    )

    source: Text | None = None
    """Where the section's numbers come from; `"assumed"` is allowed, and shown."""

    @field_validator("*")
    @classmethod
    def _can_be_reckoned_with(cls, value: Any) -> Any:
        if isinstance(value, float) and value and not LEAST_SIZE <= abs(value) <= LARGEST_SIZE:
            raise PydanticCustomError(
                "beyond_reckoning", f"of a size beyond {LEAST_SIZE:g} to {LARGEST_SIZE:g}"
            )
        return value


class Mission(Section):
    """What is simulated, where on the map, and from which seed.

    `order` is the order of IHO S-44 that is asked for.
    """

    title: Text
    """Name of the mission in reports, pictures and files."""
    description: str = ""
    """What is flown."""
    expect: str = ""
    """What its flight is meant to show."""
    order: Literal["exclusive", "special", "order_1a", "order_1b", "order_2"] | None = None
    """Order of IHO S-44 that is asked for; without one the strictest that passes is told."""
    start_utc: AwareDatetime = datetime(2026, 6, 21, 10, 0, 0, tzinfo=UTC)
    """Time of the first flash, with its zone; GPS times of the points follow from it."""
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 1
    """Start of all random numbers: same scenario and seed, same bytes."""
    crs_epsg: Count = 25832
    """Projected coordinate system in metres; 25832 is UTM zone 32 north on ETRS89."""
    vertical_epsg: Count = 5714
    """Vertical datum from which elevations count; 5714 is mean sea level."""


class Flight(Section):
    """What every flight has; `survey.scenario.flight_sections` holds the kinds.

    The height counts from the water level, whatever the ground below does.
    """

    kind: str
    height_m: Height = 200.0
    """Flight height above the water level."""
    speed_m_s: Positive = 100.0
    """Speed over ground."""
    flash_rate_hz: Positive = 1.0
    """Flashes, hence frames, a second."""

    @property
    def heights_m(self) -> tuple[float, float]:
        """Least and greatest height above the water that is planned."""
        return self.height_m, self.height_m


class Laser(Section):
    """The pulse and how it fills the field of view."""

    pulse_energy_j: Positive = 1.0
    """Energy of one pulse."""
    wavelength_nm: Annotated[float, Field(ge=400.0, le=700.0)] = 532.0
    """Wavelength of the light, in vacuum."""
    pulse_width_ns: Positive = 10.0
    """Full width at half maximum of the pulse, a Gaussian."""
    illumination: Literal["flood", "isolated"] = "flood"
    """`flood` lights the whole field of view; `isolated` gives each pixel light of its own cone
    alone."""


class Camera(Section):
    """The pixel matrix; a pixel has its footprint at the design range, in air."""

    rows: Count = 32
    """Pixels along the short side."""
    columns: Count = 64
    """Pixels along the long side."""
    pixel_footprint_m: Positive = 2.0
    """Side of a pixel's footprint at the design range."""
    design_range_m: Positive = 250.0
    """Distance at which a pixel has its footprint."""
    long_side: Literal["along", "across"] = "along"
    """Whether the long side lies along the track or across it."""


class Receiver(Section):
    """Optics and gate; without `gate_start_ns` the gate opens 30 ns before the nadir surface."""

    aperture_radius_m: Positive
    """Radius of the aperture."""
    filter_width_nm: Positive
    """Width of the spectral filter, which lets the sun's light in."""
    optics_transmission: Fraction = 1.0
    """Share of the light that the optics pass."""
    gate_start_ns: NotNegative | None = None
    """When the gate opens after the pulse left; unless told, 30 ns before the echo of the water
    straight below."""
    bin_width_ns: Positive = 1.0
    """Width of a time bin."""
    bins: Annotated[int, Field(ge=1, le=100_000)] = 300
    """Number of time bins, hence the gate's length."""


class Detector(Section):
    """What every detector has; `survey.scenario.detector_sections` holds the kinds.

    A frame may be a burst of pulses, whose readings are summed.
    """

    kind: str
    quantum_efficiency: Fraction
    """Photo-electrons for each photon on the active area."""
    dark_count_rate_hz: NotNegative
    """Counts of a pixel in the dark."""
    pulses_per_frame: Count = 1
    """Pulses whose readings are summed to a frame; energy is that of one."""
    burst_rate_hz: Positive = 1.0e5
    """Pulses a second within a frame."""


class Sun(Section):
    """Background light: by the sun's place and the air, or a stated radiance instead.

    Keys without a value follow from the words beside them, see `survey.scenario.sun`.
    """

    day: bool = True
    """Whether the sun shines; by night the radiance is 1e-3 W/(m2 um sr)."""
    model: Literal["low_flight", "high_flight", "layered"] = "low_flight"
    """Which of the paper's background equations: (6), (7), or the sum (2) + (3) + (4) at the
    aircraft's height."""
    zenith_deg: Annotated[float, Field(ge=0.0, lt=90.0)] = 20.0
    """Angle of the sun off the zenith."""
    azimuth_deg: Bearing = 180.0
    """Direction in which the sun stands, from north to the east; for measured glint."""
    optical_thickness: Annotated[float, Field(ge=0.0, le=100.0)] = 0.3
    """Optical thickness of all of the air."""
    air_extinction_per_m: NotNegative | None = None
    """Extinction of the air below the aircraft, with `layered`; unless told, air is uniform up to
    10 km."""
    legendre_moment: Annotated[float, Field(ge=-3.0, le=3.0)] = 1.5
    """First Legendre moment x1 of the air's phase function, equation (5)."""
    spectrum: Literal["stated", "astm_g173"] = "stated"
    """`stated` takes `solar_irradiance_w_m2_nm`; `astm_g173` the mean of that spectrum over the
    filter."""
    solar_irradiance_w_m2_nm: NotNegative | None = None
    """Irradiance of the sun above the air; 1.95 unless told."""
    glint: Literal["paper", "cox_munk"] = "paper"
    """Brightness of the sea: the paper's numbers, or slopes measured by Cox and Munk."""
    water_light: Literal["stated", "by_water_type"] = "stated"
    """Light that leaves the water: `stated` takes `water_reflectance`; `by_water_type` goes by
    Petzold's waters."""
    water_reflectance: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    """The paper's rho_s, per steradian; 0.0097 unless told."""
    radiance_w_m2_um_sr: NotNegative | None = None
    """Radiance of the background, which replaces all of the above."""


class Transport(Section):
    """How many light paths the Monte Carlo makes and where it splits them."""

    walks_per_pixel: Annotated[int, Field(ge=3, le=1_000_000)] = 64
    """Mean number of light paths of a pixel; more of them, less Monte Carlo error."""
    replicates: Annotated[int, Field(ge=3, le=1000)] = 4
    """Independent parts of a flash, from whose scatter standard errors come."""
    tracks_per_replicate: Annotated[int, Field(ge=16, le=10_000_000)] = 1024
    """Random walks in open water that the light paths of a replicate share."""
    split_angle_deg: Annotated[float, Field(gt=0.0, lt=90.0)] = 45.0
    """Angle beyond which a scattering counts as the turn of a path; results must not depend on it.
    """
    column_spacing: Positive = 1.0
    """Path between the points where the column is lit, in attenuation lengths 1 / c."""


class Processing(Section):
    """From counts to points and grids; without `echo_gate_ns` an echo is one pulse width long.

    `ranging` is how the bottom is looked for: by a matched filter, weak echoes together with their
    neighbours, or by the threshold of [Lisenko2017] in each pixel alone. With the filter, pixels
    without a bottom may be looked at a second time, at `second_look_rate`: what is found then
    becomes a bottom where enough frames that overlap agree.

    Rays bend at the `mean_level` of the water or at `local_waves`, planes through neighbouring
    first echoes. `correct_scattering` takes from the ranges what scattered light is expected to do
    to them. `water_level_error_m` is how far the level that is expected, before the first echoes
    tell it, lies above the true one. Thresholds are made for the water with its layers, unless
    `expects_layers` is false: then for that of [water] alone. `keep_waveforms` keeps the detector's
    histograms and time tags in the frames' files: of one pixel in 8 x 8, or of all.
    """

    ranging: Literal["matched", "threshold"] = "matched"
    """How bottoms are looked for: `matched`, with neighbours' help, or `threshold`, each pixel
    alone."""
    false_alarm_rate: Annotated[float, Field(gt=0.0, lt=1.0)] = 1e-3
    """Probability of a false bottom in a pixel and flash, over the whole gate."""
    second_look_rate: Annotated[float, Field(ge=0.0, le=0.3)] = 0.0
    """The same of candidates, which become bottoms where other frames agree; 0 is no such look."""
    echo_gate_ns: Positive | None = None
    """Length of the gate in which an echo's counts are summed; one pulse width unless told."""
    expects_layers: bool = True
    """Whether thresholds know the layers of the water."""
    refraction: Literal["mean_level", "local_waves"] = "mean_level"
    """Rays bend at the mean level, or at planes through neighbouring first echoes."""
    correct_scattering: bool = True
    """Whether what scattered light is expected to do to ranges is taken off them."""
    water_level_error_m: Annotated[float, Field(ge=-10.0, le=10.0)] = 0.0
    """Level that the survey expects, less the true one."""
    thinning_m: NotNegative = 1.0
    """Side of the cells of which one point stays; 0 keeps all."""
    grid_m: Annotated[float, Field(ge=0.01)] = 2.0
    """Side of the cells of rasters and meshes."""
    keep_waveforms: Literal["none", "sampled", "all"] = "none"
    """Whose readings stay in the frames' files: nobody's, one pixel's in 8 x 8, all."""


class Run(Section):
    """How the work is shared out; 0 workers means one for each core."""

    workers: Annotated[int, Field(ge=0, le=10_000)] = 0
    """Frames flown at once; 0 is one for each core."""
