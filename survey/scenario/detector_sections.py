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


class SpadDetector(CatalogueDetector):
    """Geiger mode: one pulse for an avalanche, then dead time.

    `quantum_efficiency` counts avalanches per photon on the active area. Times of gates count
    from the echo of the level sea straight below; in `surface_pulses` of a frame's pulses the
    surface gate alone is armed, in the others the bottom gate, and 0 arms both in every pulse.
    """

    kind: Literal["spad"] = "spad"
    fill_factor: Fraction = 1.0
    dead_time_ns: Annotated[float, Field(ge=0.1)]
    afterpulse_probability: Probability = 0.0
    afterpulse_lifetime_ns: Positive = 50.0
    crosstalk_probability: Annotated[float, Field(ge=0.0, lt=0.25)] = 0.0
    timing_jitter_ps: NotNegative = 0.0
    max_counts_per_bin: CounterRoom = 65_535
    surface_gate_open_ns: float | None = None
    surface_gate_close_ns: float | None = None
    bottom_gate_open_ns: float | None = None
    bottom_gate_close_ns: float | None = None
    gates_follow_slant: bool = False
    surface_pulses: Annotated[int, Field(ge=0)] = 0

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
    ionisation_ratio: Annotated[float, Field(ge=0.0, le=1.0)]
    bandwidth_mhz: Positive
    amplifier_noise_pa_per_sqrt_hz: NotNegative
    full_scale_photo_electrons: Positive = 1.0e6


class PmtDetector(CatalogueDetector):
    """A photomultiplier: counts where pulses are apart, a current where they overlap."""

    kind: Literal["pmt"] = "pmt"
    gain: Annotated[float, Field(ge=1.0)] = 1.0e6
    secondary_emission: Annotated[float, Field(gt=1.0)] = 5.0
    rc_ns: Positive
    amplifier_noise_pa_per_sqrt_hz: NotNegative = 0.0
    transit_time_spread_ps: NotNegative = 0.0
    full_scale_photo_electrons: Positive = 1.0e6


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
