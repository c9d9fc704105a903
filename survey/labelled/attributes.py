"""What holds for all waveforms of a data set, as its attributes."""

from __future__ import annotations

import hashlib
from importlib import metadata
from typing import Any

from survey.preparation import Mission
from survey.scenario.scenario import Scenario

CONVENTIONS = "CF-1.11"
SIMULATED = (
    "Everything here is simulated; nothing was measured from an aircraft. Expected light, "
    "thresholds and truth are known because they are the simulation's own."
)


def mission_attributes(mission: Mission) -> dict[str, Any]:
    """Return the instrument, the water and the words that CF asks for."""
    engine, noise = mission.engine, mission.noise
    laser, receiver, water = engine.laser, engine.receiver, engine.water
    return {
        "Conventions": CONVENTIONS,
        "title": mission.products.title,
        "source": f"simulated by bathyflash {metadata.version('bathyflash')}",
        "comment": SIMULATED,
        "seed": engine.seed,
        "wavelength_m": laser.wavelength,
        "pulse_energy_j": laser.pulse_energy,
        "pulse_fwhm_s": laser.pulse_fwhm,
        "aperture_radius_m": receiver.aperture_radius,
        "gate_start_s": receiver.gate_start,
        "bin_width_s": receiver.bin_width,
        "gate_bins": noise.gate_bins,
        "detector": type(mission.detector).__name__,
        "photo_electrons_per_photon": mission.detector.photo_electrons_per_photon,
        "dark_count_rate_hz": mission.detector.dark_count_rate,
        "refractive_index": water.refractive_index,
        "group_index": water.group_index,
        "water_level_m": mission.products.water_level,
        "camera_rows": mission.camera.rows,
        "camera_columns": mission.camera.columns,
    }


def scenario_attributes(scenario: Scenario) -> dict[str, Any]:
    """Return the resolved scenario, its hash, and how many pulses a frame has."""
    text = scenario.to_toml()
    return {
        "scenario": text,
        "scenario_sha256": hashlib.sha256(text.encode()).hexdigest(),
        "pulses_per_frame": scenario.detector.pulses_per_frame,
    }
