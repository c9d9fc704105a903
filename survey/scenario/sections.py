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
    description: str = ""
    expect: str = ""
    order: Literal["exclusive", "special", "order_1a", "order_1b", "order_2"] | None = None
    start_utc: AwareDatetime = datetime(2026, 6, 21, 10, 0, 0, tzinfo=UTC)
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 1
    crs_epsg: Count = 25832
    vertical_epsg: Count = 5714


class Flight(Section):
    """What every flight has; `survey.scenario.flight_sections` holds the kinds.

    The height counts from the water level, whatever the ground below does.
    """

    kind: str
    height_m: Height = 200.0
    speed_m_s: Positive = 100.0
    flash_rate_hz: Positive = 1.0

    @property
    def heights_m(self) -> tuple[float, float]:
        """Least and greatest height above the water that is planned."""
        return self.height_m, self.height_m


class Laser(Section):
    """The pulse and how it fills the field of view."""

    pulse_energy_j: Positive = 1.0
    wavelength_nm: Annotated[float, Field(ge=400.0, le=700.0)] = 532.0
    pulse_width_ns: Positive = 10.0
    illumination: Literal["flood", "isolated"] = "flood"


class Camera(Section):
    """The pixel matrix; a pixel has its footprint at the design range, in air."""

    rows: Count = 32
    columns: Count = 64
    pixel_footprint_m: Positive = 2.0
    design_range_m: Positive = 250.0
    long_side: Literal["along", "across"] = "along"


class Receiver(Section):
    """Optics and gate; without `gate_start_ns` the gate opens 30 ns before the nadir surface."""

    aperture_radius_m: Positive
    filter_width_nm: Positive
    optics_transmission: Fraction = 1.0
    gate_start_ns: NotNegative | None = None
    bin_width_ns: Positive = 1.0
    bins: Annotated[int, Field(ge=1, le=100_000)] = 300


class Detector(Section):
    """What every detector has; `survey.scenario.detector_sections` holds the kinds.

    A frame may be a burst of pulses, whose readings are summed.
    """

    kind: str
    quantum_efficiency: Fraction
    dark_count_rate_hz: NotNegative
    pulses_per_frame: Count = 1
    burst_rate_hz: Positive = 1.0e5


class Sun(Section):
    """Background light: by the sun's place and the air, or a stated radiance instead.

    Keys without a value follow from the words beside them, see `survey.scenario.sun`.
    """

    day: bool = True
    model: Literal["low_flight", "high_flight", "layered"] = "low_flight"
    zenith_deg: Annotated[float, Field(ge=0.0, lt=90.0)] = 20.0
    azimuth_deg: Bearing = 180.0
    optical_thickness: Annotated[float, Field(ge=0.0, le=100.0)] = 0.3
    air_extinction_per_m: NotNegative | None = None
    legendre_moment: Annotated[float, Field(ge=-3.0, le=3.0)] = 1.5
    spectrum: Literal["stated", "astm_g173"] = "stated"
    solar_irradiance_w_m2_nm: NotNegative | None = None
    glint: Literal["paper", "cox_munk"] = "paper"
    water_light: Literal["stated", "by_water_type"] = "stated"
    water_reflectance: Annotated[float, Field(ge=0.0, le=1.0)] | None = None
    radiance_w_m2_um_sr: NotNegative | None = None


class Transport(Section):
    """How many light paths the Monte Carlo makes and where it splits them."""

    walks_per_pixel: Annotated[int, Field(ge=3, le=1_000_000)] = 64
    replicates: Annotated[int, Field(ge=3, le=1000)] = 4
    tracks_per_replicate: Annotated[int, Field(ge=16, le=10_000_000)] = 1024
    split_angle_deg: Annotated[float, Field(gt=0.0, lt=90.0)] = 45.0
    column_spacing: Positive = 1.0


class Processing(Section):
    """From counts to points and grids; without `echo_gate_ns` an echo is one pulse width long.

    `ranging` is how the bottom is looked for: by a matched filter, weak echoes together with their
    neighbours, or by the threshold of [Lisenko2017] in each pixel alone.

    Rays bend at the `mean_level` of the water or at `local_waves`, planes through neighbouring
    first echoes. `correct_scattering` takes from the ranges what scattered light is expected to do
    to them. `water_level_error_m` is how far the level that is expected, before the first echoes
    tell it, lies above the true one. Thresholds are made for the water with its layers, unless
    `expects_layers` is false: then for that of [water] alone. `keep_waveforms` keeps the detector's
    histograms and time tags in the frames' files: of one pixel in 8 x 8, or of all.
    """

    ranging: Literal["matched", "threshold"] = "matched"
    false_alarm_rate: Annotated[float, Field(gt=0.0, lt=1.0)] = 1e-3
    echo_gate_ns: Positive | None = None
    expects_layers: bool = True
    refraction: Literal["mean_level", "local_waves"] = "mean_level"
    correct_scattering: bool = True
    water_level_error_m: Annotated[float, Field(ge=-10.0, le=10.0)] = 0.0
    thinning_m: NotNegative = 1.0
    grid_m: Annotated[float, Field(ge=0.01)] = 2.0
    keep_waveforms: Literal["none", "sampled", "all"] = "none"


class Run(Section):
    """How the work is shared out; 0 workers means one for each core."""

    workers: Annotated[int, Field(ge=0, le=10_000)] = 0
