"""Rules that bind the keys of a detector together, and to gate, camera and flight."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from survey.scenario.detector_sections import SpadDetector
from survey.scenario.faults import Fault
from survey.scenario.sections import Camera, Detector, Flight, Processing, Receiver
from survey.scenario.times import gate_start_ns, two_way_ns

PIXELS_SMEARED = 0.5


def echo_gate_holds_a_bin(processing: Processing, receiver: Receiver) -> Iterator[Fault]:
    """Counts are summed over whole bins."""
    gate = processing.echo_gate_ns
    if gate is not None and gate < receiver.bin_width_ns:
        yield Fault(
            "processing.echo_gate_ns",
            f"{gate:g} is shorter than a bin of {receiver.bin_width_ns:g} ns. "
            "Widen it, or narrow receiver.bin_width_ns.",
        )


def burst_fits(
    detector: Detector, receiver: Receiver, flight: Flight, camera: Camera
) -> Iterator[Fault]:
    """A burst's echoes stay apart, and it ends before the next frame and the next pixel."""
    if detector.pulses_per_frame == 1:
        return
    interval_ns = 1e9 / detector.burst_rate_hz
    gate_end_ns = gate_start_ns(receiver, flight) + receiver.bins * receiver.bin_width_ns
    if gate_end_ns > interval_ns:
        yield Fault(
            "detector.burst_rate_hz",
            f"pulses follow each other after {interval_ns:.0f} ns, but the gate closes at "
            f"{gate_end_ns:.0f} ns: their echoes mix. Stay below {1e9 / gate_end_ns:.0f}.",
        )
    duration = detector.pulses_per_frame / detector.burst_rate_hz
    pixel_m = camera.pixel_footprint_m / camera.design_range_m * flight.height_m
    moved_m = flight.speed_m_s * duration
    if moved_m > PIXELS_SMEARED * pixel_m:
        yield Fault(
            "detector.pulses_per_frame",
            f"the burst takes {1e3 * duration:.3g} ms, in which the aircraft flies "
            f"{moved_m:.3g} m, more than half a pixel of {pixel_m:.3g} m. "
            "Fire fewer pulses, or faster.",
        )
    if duration > 1.0 / flight.flash_rate_hz:
        yield Fault(
            "detector.pulses_per_frame",
            f"the burst takes {1e3 * duration:.3g} ms and the next one begins after "
            f"{1e3 / flight.flash_rate_hz:.3g} ms. Fire fewer pulses, or faster.",
        )


def dead_time_ends_before_the_next_pulse(detector: Detector, flight: Flight) -> Iterator[Fault]:
    """Each pulse finds all pixels live."""
    burst = detector.pulses_per_frame > 1
    rate = detector.burst_rate_hz if burst else flight.flash_rate_hz
    if isinstance(detector, SpadDetector) and detector.dead_time_ns > 1e9 / rate:
        yield Fault(
            "detector.dead_time_ns",
            f"{detector.dead_time_ns:g} is longer than the {1e9 / rate:.0f} ns between pulses "
            f"({'detector.burst_rate_hz' if burst else 'flight.flash_rate_hz'}). Shorten it.",
        )


def spad_gates_are_gates(detector: Detector, receiver: Receiver, flight: Flight) -> Iterator[Fault]:
    """A gate has two ends, holds a bin, and lies inside the receiver's gate."""
    if not isinstance(detector, SpadDetector):
        return
    first = gate_start_ns(receiver, flight) - two_way_ns(flight.height_m)
    last = first + receiver.bins * receiver.bin_width_ns
    for name, (open_ns, close_ns) in detector.gates_ns.items():
        if (open_ns is None) != (close_ns is None):
            yield Fault(f"detector.{name}", "a gate needs both its open_ns and its close_ns.")
        if open_ns is None or close_ns is None:
            continue
        if close_ns - open_ns < receiver.bin_width_ns:
            yield Fault(
                f"detector.{name}_close_ns",
                f"{close_ns:g} is less than a bin of {receiver.bin_width_ns:g} ns after "
                f"{name}_open_ns {open_ns:g}. Close later.",
            )
        elif open_ns > last - receiver.bin_width_ns or close_ns < first + receiver.bin_width_ns:
            yield Fault(
                f"detector.{name}_open_ns",
                f"the gate from {open_ns:g} to {close_ns:g} ns holds no bin of the receiver, whose "
                f"gate lasts from {first:.0f} to {last:.0f} ns after the nadir surface. Move it.",
            )


def surface_pulses_have_both_gates(detector: Detector) -> Iterator[Fault]:
    """Pulses are shared out between two gates that exist."""
    if not isinstance(detector, SpadDetector) or detector.surface_pulses == 0:
        return
    if any(end is None for gate in detector.gates_ns.values() for end in gate):
        yield Fault(
            "detector.surface_pulses",
            "pulses are shared out between a surface gate and a bottom gate. State both.",
        )
    if detector.surface_pulses >= detector.pulses_per_frame:
        yield Fault(
            "detector.surface_pulses",
            f"{detector.surface_pulses} leave none of pulses_per_frame "
            f"{detector.pulses_per_frame} for the bottom. Lower it.",
        )


DETECTOR_RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    echo_gate_holds_a_bin,
    burst_fits,
    dead_time_ends_before_the_next_pulse,
    spad_gates_are_gates,
    surface_pulses_have_both_gates,
)
