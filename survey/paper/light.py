"""What one water sends to a pixel: column, surface and bottom, batch by batch."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.optics.water import Water, petzold_water
from survey.paper import instrument
from survey.paper.power import FOOTPRINT, PULSE_SIGMA, blurred, energy_at, surface_energy
from survey.transport.response_column import column_batches
from survey.transport.response_echo import echo_batches

FloatArray = NDArray[np.float64]

BIN = 0.25
EDGES: FloatArray = np.arange(0.0, 90.0 + BIN, BIN)
MIDDLE: FloatArray = EDGES[:-1] + 0.5 * BIN
DEPTH: FloatArray = np.arange(-2.0 + 0.5 * BIN, 90.0, BIN)
AT_ONCE: FloatArray = np.array([-1e-6, 1e-6])
LATE_BIN = 0.125
LATE_EDGES: FloatArray = np.arange(0.0, 10.0 + LATE_BIN, LATE_BIN)
SPLIT_ANGLE = math.radians(45.0)
FULL_BLOCKS = {"P02": 32, "P05": 64, "P07": 128}
FULL_WALKS = 4000
LEAST_BLOCKS, LEAST_WALKS = 2, 64
SWEEP = 28
SWEEP_TO = {"P02": 13.5, "P05": 21.0, "P07": 40.0}


@dataclass(frozen=True, kw_only=True)
class Light:
    """Power per area of the aperture that one water sends to a pixel at nadir.

    The second axis of batches is the illumination: flood and isolated.

    Parameters
    ----------
    water : Water
    depth : array (depths,)
        Half of the path in the water; below 0 the pulse is still coming up [m].
    column : array (batches, 2, depths)
        Of bottomless water [W/m2].
    column_above : array (batches, 2, depths)
        Of the column above a bottom at 50 m; light that comes after its echo is left out [W/m2].
    surface : array (depths,)
        [W/m2].
    bottom : array (batches, 2, depths)
        Of a bottom at 50 m [W/m2].
    sweep_depth : array (sweep,)
        Depths of other bottoms [m].
    sweep_peak : array (batches, 2, sweep)
        The highest power of each of their echoes [W/m2].
    """

    water: Water
    depth: FloatArray
    column: FloatArray
    column_above: FloatArray
    surface: FloatArray
    bottom: FloatArray
    sweep_depth: FloatArray
    sweep_peak: FloatArray

    @property
    def total(self) -> FloatArray:
        """Power of surface, column and bottom together (batches, 2, depths) [W/m2]."""
        return self.column_above + self.bottom + self.surface


def light_of(name: str, *, work: float = 1.0, seed: int = 1, threads: int = 1) -> Light:
    """Trace one of the paper's waters.

    Parameters
    ----------
    name : {"P02", "P05", "P07"}
    work : float
        Walks over those of the full command [1].
    seed, threads : int
    """
    water = petzold_water(
        instrument.WATERS[name], refractive_index=instrument.INDEX, group_index=instrument.INDEX
    )
    return trace(
        water=water,
        sweep=np.linspace(0.5, SWEEP_TO[name], SWEEP) / water.attenuation,
        blocks=max(LEAST_BLOCKS, round(work * FULL_BLOCKS[name])),
        walks=max(LEAST_WALKS, round(work * FULL_WALKS)),
        seed=seed,
        threads=threads,
    )


def trace(
    *, water: Water, sweep: FloatArray, blocks: int, walks: int, seed: int = 1, threads: int = 1
) -> Light:
    """Trace any water under the paper's instrument.

    Parameters
    ----------
    water : Water
    sweep : array (sweep,)
        Depths of bottoms, growing [m].
    blocks : int
        Blocks of 16 walks each way for the column, in each of 64 batches.
    walks : int
        Walks each way to the bottoms, in each batch.
    seed, threads : int
    """
    column = column_batches(
        water=water,
        footprint=FOOTPRINT,
        bins=len(MIDDLE),
        bin_width=BIN,
        seed=seed,
        split_angle=SPLIT_ANGLE,
        blocks=blocks,
        threads=threads,
    )
    energy = column * BIN * energy_at(MIDDLE)
    above = np.where(MIDDLE < instrument.BOTTOM_DEPTH, energy, 0.0)
    bottoms = np.union1d(sweep, [instrument.BOTTOM_DEPTH])
    echo = echo_batches(
        water=water,
        footprint=FOOTPRINT,
        depths=bottoms,
        bins=len(LATE_EDGES) - 1,
        bin_width=LATE_BIN,
        seed=seed,
        walks=walks,
        threads=threads,
    )
    at_50 = echo[:, :, np.searchsorted(bottoms, instrument.BOTTOM_DEPTH)]
    return Light(
        water=water,
        depth=DEPTH,
        column=blurred(energy=energy, edges=EDGES, depth=DEPTH),
        column_above=blurred(energy=above, edges=EDGES, depth=DEPTH),
        surface=blurred(energy=np.array([surface_energy()]), edges=AT_ONCE, depth=DEPTH),
        bottom=_echo_power(at_50, instrument.BOTTOM_DEPTH, DEPTH),
        sweep_depth=sweep,
        sweep_peak=_peaks(echo[:, :, np.searchsorted(bottoms, sweep)], sweep),
    )


def _echo_power(two_way: FloatArray, bottom: float, depth: FloatArray) -> FloatArray:
    energy = two_way * (instrument.BOTTOM_REFLECTANCE / np.pi) * energy_at(np.array(bottom))
    return blurred(energy=energy, edges=bottom + LATE_EDGES, depth=depth)


def _peaks(two_way: FloatArray, bottoms: FloatArray) -> FloatArray:
    """Return the highest power of each echo, at the place where the mean of batches has it."""
    peaks = np.empty(two_way.shape[:3])
    around: FloatArray = np.arange(-1.0, 5.0, 0.1) * PULSE_SIGMA
    for k, bottom in enumerate(bottoms):
        power = _echo_power(two_way[:, :, k], bottom, bottom + around)
        place = power.mean(axis=0).argmax(axis=-1)
        for which, at in enumerate(place):
            peaks[:, which, k] = power[:, which, at]
    return peaks
