"""The section [detector]: one set of keys for each kind, and devices that fill them in."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, field_validator
from pydantic_core import PydanticCustomError

from survey.scenario.sections import Detector, Fraction, NotNegative, Positive, Text
from survey.sensor.catalogue import devices

CounterRoom = Annotated[int, Field(ge=1, le=65_535)]
IdealRoom = Annotated[int, Field(ge=1, le=2**31 - 1)]
Probability = Annotated[float, Field(ge=0.0, lt=1.0)]


class CatalogueDetector(Detector):
    """A detector whose figures may come from the catalogue; keys that are given come first."""

    device: Text | None = None
    """A device of the catalogue, whose figures are the defaults."""

    @field_validator("device")
    @classmethod
    def _is_in_the_catalogue(cls, name: str | None) -> str | None:
        if name is None:
            return None
        kind = cls.model_fields["kind"].default
        of_kind = [known for known, device in devices().items() if device.kind == kind]
        if name in devices() and name not in of_kind:
            text = f"it is of kind {devices()[name].kind}. Leave kind out, or choose another device"
            raise PydanticCustomError("device_of_other_kind", text)
        if name not in of_kind:
            expected = ", ".join(devices() if kind == "ideal" else of_kind)
            raise PydanticCustomError("literal_error", "no such device", {"expected": expected})
        return name


class IdealDetector(CatalogueDetector):
    """Counts every photo-electron."""

    kind: Literal["ideal"] = "ideal"
    max_counts_per_bin: IdealRoom = 65_535
    """Highest count of a bin."""


class SpadDetector(CatalogueDetector):
    """Geiger mode: one pulse for an avalanche, then dead time.

    `quantum_efficiency` counts avalanches per photon on the active area. Times of gates count
    from the echo of the level sea straight below; in `surface_pulses` of a frame's pulses the
    surface gate alone is armed, in the others the bottom gate, and 0 arms both in every pulse.
    """

    kind: Literal["spad"] = "spad"
    fill_factor: Fraction = 1.0
    """Share of the pixel that is active."""
    dead_time_ns: Annotated[float, Field(ge=0.1)]
    """Time after an avalanche in which the pixel sees nothing."""
    afterpulse_probability: Probability = 0.0
    """Probability that an avalanche starts another, later one."""
    afterpulse_lifetime_ns: Positive = 50.0
    """Mean time from the end of the dead time to such a one."""
    crosstalk_probability: Annotated[float, Field(ge=0.0, lt=0.25)] = 0.0
    """Probability that an avalanche starts one in a given neighbour, of four."""
    timing_jitter_ps: NotNegative = 0.0
    """Full width at half maximum of a count's scatter in time."""
    max_counts_per_bin: CounterRoom = 65_535
    """Highest count of a bin."""
    surface_gate_open_ns: float | None = None
    """When pixels are armed for the surface, after the echo of level water straight below."""
    surface_gate_close_ns: float | None = None
    """When that gate closes."""
    bottom_gate_open_ns: float | None = None
    """When pixels are armed for the bottom, after the same echo."""
    bottom_gate_close_ns: float | None = None
    """When that gate closes."""
    gates_follow_slant: bool = False
    """Whether the gates come later in slanting pixels, as the water's echo does."""
    surface_pulses: Annotated[int, Field(ge=0)] = 0
    """Pulses of a frame with the surface gate alone, the others have the bottom's; 0 arms both in
    all."""

    @property
    def gates_ns(self) -> dict[str, tuple[float | None, float | None]]:
        """Both ends of the gates by their name."""
        return {
            "surface_gate": (self.surface_gate_open_ns, self.surface_gate_close_ns),
            "bottom_gate": (self.bottom_gate_open_ns, self.bottom_gate_close_ns),
        }


class ApdDetector(CatalogueDetector):
    """Linear mode: a sampled current with the noise of its gain and of its amplifier."""

    kind: Literal["apd"] = "apd"
    gain: Annotated[float, Field(ge=1.0)]
    """Mean gain of an avalanche."""
    ionisation_ratio: Annotated[float, Field(ge=0.0, le=1.0)]
    """McIntyre's k, ionisation by holes over that by electrons."""
    bandwidth_mhz: Positive
    """Bandwidth of diode and amplifier."""
    amplifier_noise_pa_per_sqrt_hz: NotNegative
    """Current noise of the amplifier at its input."""
    full_scale_photo_electrons: Positive = 1.0e6
    """Reading of a bin at which it saturates."""


class PmtDetector(CatalogueDetector):
    """A photomultiplier: counts where pulses are apart, a current where they overlap."""

    kind: Literal["pmt"] = "pmt"
    gain: Annotated[float, Field(ge=1.0)] = 1.0e6
    """Mean gain of the dynodes."""
    secondary_emission: Annotated[float, Field(gt=1.0)] = 5.0
    """Mean secondary electrons at the first dynode, which set the scatter of pulse heights."""
    rc_ns: Positive
    """Time constant: pulses are counted while 1/rate is longer, beyond it a current is read."""
    amplifier_noise_pa_per_sqrt_hz: NotNegative = 0.0
    """Current noise of the amplifier at its input."""
    transit_time_spread_ps: NotNegative = 0.0
    """Full width at half maximum of a pulse's scatter in time."""
    full_scale_photo_electrons: Positive = 1.0e6
    """Reading of a bin at which it saturates."""


def _with_device(given: Any) -> Any:
    """Fill in what a device of the catalogue says and the keys do not; without either, ideal."""
    if not isinstance(given, Mapping):
        return given
    name = given.get("device")
    device = devices().get(name) if isinstance(name, str) else None
    if device is None:
        return {"kind": "ideal", **given}
    if given.get("kind", device.kind) != device.kind:
        return given
    figures = {key: figure.value for key, figure in device.figures.items()}
    return {"kind": device.kind, **figures, **given}


AnyDetector = Annotated[
    IdealDetector | SpadDetector | ApdDetector | PmtDetector,
    Field(discriminator="kind"),
    BeforeValidator(_with_device),
]
