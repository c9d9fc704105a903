"""Store what the reference engine says of uniform frames, 10 m deep: coastal water, and layers.

Run it by hand after a change of the reference engine: it takes ten minutes a water on two cores.

    python tests/regression/reference_flashes.py coastal
"""

from __future__ import annotations

import json
import sys
from math import radians
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import convolve1d

from survey.flight.pose import Pose
from survey.optics.water import Water, WaterColumn, petzold_water
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.reference import reference_flash
from survey.transport.waveforms import pulse_taps

DEPTH, REFLECTANCE, INDEX = 10.0, 0.1, 1.33
BATCHES, WALKS_PER_BATCH = 64, 5_000_000
BAND_BINS = 10

LASER = Laser(pulse_energy=1.0, wavelength=532e-9, pulse_fwhm=10e-9)
CAMERA = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
RECEIVER = Receiver(
    aperture_radius=40.0,
    filter_width=1e-9,
    optics_transmission=1.0,
    gate_start=1.3e-6,
    bin_width=1e-9,
    bins=300,
)
POSE = Pose(position=np.array([0.0, 0.0, 200.0]), roll=0.0, pitch=0.0, heading=0.0)


def _petzold(name: str) -> Water:
    return petzold_water(name, refractive_index=INDEX, group_index=INDEX)


COASTAL = WaterColumn.uniform(_petzold("coastal"))
WATERS = {
    "coastal": COASTAL,
    # 1 m of harbor water between coastal and clear water.
    "layers": COASTAL.with_layer(_petzold("harbor"), top=4.0, bottom=5.0).with_layer(
        _petzold("clear"), top=5.0
    ),
}


def stored_file(water: str) -> Path:
    """Return where the result of one of `WATERS` is kept."""
    return Path(__file__).parent / "data" / f"reference_{water}.json"


def bands(bins: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum the last axis over 10 ns."""
    return bins.reshape(*bins.shape[:-1], -1, BAND_BINS).sum(axis=-1)


def run_reference(
    water: str, *, batches: int, walks_per_batch: int, seed: int
) -> NDArray[np.float64]:
    """Return photons (batches, column and bottom, bands of 10 ns), pooled over all pixels."""
    impulse = reference_flash(
        water=WATERS[water],
        depth=DEPTH,
        reflectance=REFLECTANCE,
        laser=LASER,
        camera=CAMERA,
        receiver=RECEIVER,
        pose=POSE,
        walks_per_batch=walks_per_batch,
        batches=batches,
        peak_angle=radians(30.0),
        seed=seed,
    )
    pulse = pulse_taps(sigma=LASER.pulse_sigma, width=RECEIVER.bin_width, pad=20)
    return bands(convolve1d(impulse, pulse, axis=-1, mode="constant"))


def main(water: str) -> None:
    """Run the reference engine and store means and standard errors."""
    batches = run_reference(water, batches=BATCHES, walks_per_batch=WALKS_PER_BATCH, seed=2017)
    content = {
        "what": "photons through the aperture in bands of 10 ns from 1300 ns, all pixels pooled",
        "walks": BATCHES * WALKS_PER_BATCH,
        "column": batches[:, 0].mean(axis=0).tolist(),
        "bottom": batches[:, 1].mean(axis=0).tolist(),
        "column_error": (batches[:, 0].std(axis=0, ddof=1) / BATCHES**0.5).tolist(),
        "bottom_error": (batches[:, 1].std(axis=0, ddof=1) / BATCHES**0.5).tolist(),
    }
    stored_file(water).write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
