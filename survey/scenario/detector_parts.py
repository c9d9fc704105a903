"""The section [detector] turned into a detector, in SI units.

`survey.sensor` is imported when a detector is built, so that checking a scenario stays quick.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.scenario import detector_sections as kinds
from survey.scenario.scenario import Scenario
from survey.scenario.times import gate_start_ns, two_way_ns

if TYPE_CHECKING:
    from survey.sensor.detector import Detector
    from survey.sensor.spad import Look, Spad

NANO = 1e-9
PICO = 1e-12
MEGA = 1e6
FWHM_IN_SIGMA = 2.3548200450309493


def build_detector(scenario: Scenario) -> Detector:
    """Return the detector that a scenario states."""
    given, bin_width = scenario.detector, scenario.receiver.bin_width_ns * NANO
    common: dict[str, Any] = {
        "quantum_efficiency": given.quantum_efficiency,
        "dark_count_rate": given.dark_count_rate_hz,
    }
    if isinstance(given, kinds.SpadDetector):
        return _spad(given, scenario, common | {"bin_width": bin_width})
    common |= {"pulses": given.pulses_per_frame}
    if isinstance(given, kinds.ApdDetector):
        from survey.sensor.apd import LinearApd

        return LinearApd(
            gain=given.gain,
            ionisation_ratio=given.ionisation_ratio,
            amplifier_noise=given.amplifier_noise_pa_per_sqrt_hz * PICO,
            bandwidth=given.bandwidth_mhz * MEGA,
            full_scale=given.full_scale_photo_electrons,
            bin_width=bin_width,
            **common,
        )
    if isinstance(given, kinds.PmtDetector):
        from survey.sensor.pmt import Pmt

        return Pmt(
            gain=given.gain,
            secondary_emission=given.secondary_emission,
            rc=given.rc_ns * NANO,
            amplifier_noise=given.amplifier_noise_pa_per_sqrt_hz * PICO,
            transit_time_sigma=given.transit_time_spread_ps * PICO / FWHM_IN_SIGMA,
            full_scale=given.full_scale_photo_electrons,
            bin_width=bin_width,
            **common,
        )
    assert isinstance(given, kinds.IdealDetector)
    from survey.sensor.ideal import IdealCounter

    return IdealCounter(max_counts_per_bin=given.max_counts_per_bin, **common)


def _spad(given: kinds.SpadDetector, scenario: Scenario, common: dict[str, Any]) -> Spad:
    from survey.sensor.spad import Spad

    return Spad(
        fill_factor=given.fill_factor,
        dead_time=given.dead_time_ns * NANO,
        afterpulse_probability=given.afterpulse_probability,
        afterpulse_lifetime=given.afterpulse_lifetime_ns * NANO,
        crosstalk_probability=given.crosstalk_probability,
        jitter_sigma=given.timing_jitter_ps * PICO / FWHM_IN_SIGMA,
        max_counts_per_bin=given.max_counts_per_bin,
        looks=tuple(_looks(given, scenario)),
        keep_tags=scenario.processing.keep_waveforms != "none",
        **common,
    )


def _looks(given: kinds.SpadDetector, scenario: Scenario) -> list[Look]:
    from survey.sensor.spad import Look

    after_surface = _after_surface_ns(given, scenario)
    gates = [
        (after_surface >= open_ns) & (after_surface <= close_ns)
        for open_ns, close_ns in given.gates_ns.values()
        if open_ns is not None and close_ns is not None
    ]
    if given.surface_pulses > 0:
        rest = given.pulses_per_frame - given.surface_pulses
        shares = [(gates[0], given.surface_pulses), (gates[1], rest)]
        return [Look(armed=armed, pulses=pulses) for armed, pulses in shares if pulses > 0]
    armed = np.any(gates, axis=0) if gates else np.ones(after_surface.shape, np.bool_)
    return [Look(armed=armed, pulses=given.pulses_per_frame)]


def _after_surface_ns(given: kinds.SpadDetector, scenario: Scenario) -> NDArray[np.float64]:
    """Return the middles of the bins after the echo from which gates count [ns].

    (1, 1, bins) after that of the level sea straight below, or (rows, columns, bins) after that
    of each pixel.
    """
    from survey.scenario.components import camera

    receiver, height_m = scenario.receiver, scenario.flight.height_m
    first = gate_start_ns(receiver, scenario.flight)
    middles = first + (np.arange(receiver.bins) + 0.5) * receiver.bin_width_ns
    slant = np.ones((1, 1))
    if given.gates_follow_slant:
        forward, right = camera(scenario).pixel_centres()
        slant = np.sqrt(1.0 + forward**2 + right**2)
    return np.asarray(middles - two_way_ns(height_m) * slant[..., None])
