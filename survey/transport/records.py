"""What walks leave behind: arrivals at the bottom and crossings of the column's planes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.transport.scene import Layers
from terrain.kernels import leaf_kernel

LAUNCHED, FACETS, REFLECTED, ABSORBED, ESCAPED, ASIDE, LATE, SEABED, ROULETTE = range(9)
FLATTEST = 0.01
LEDGER_NAMES = (
    "launched",
    "facet weighting",
    "reflected at the surface",
    "absorbed by water",
    "escaped through the surface",
    "left sideways",
    "later than the gate",
    "absorbed by the bottom",
    "roulette",
)


class Records(NamedTuple):
    """Growing lists of one set of walks; ``filled`` holds how many stand in each.

    A count beyond the capacity says how much room is needed: nothing is written past the end.
    The third count is that of all scatterings.
    """

    patch: NDArray[np.int64]
    patch_owner: NDArray[np.int32]
    patch_batch: NDArray[np.uint8]
    patch_time: NDArray[np.float32]
    patch_weight: NDArray[np.float32]
    patch_gain: NDArray[np.float32]
    cell: NDArray[np.int64]
    cell_owner: NDArray[np.int32]
    cell_batch: NDArray[np.uint8]
    cell_time: NDArray[np.float32]
    cell_weight: NDArray[np.float32]
    cell_direction: NDArray[np.float32]
    filled: NDArray[np.int64]
    ledger: NDArray[np.float64]


def empty_records(*, arrivals: int, crossings: int) -> Records:
    """Return room for so many arrivals and crossings."""
    return Records(
        patch=np.empty(arrivals, np.int64),
        patch_owner=np.empty(arrivals, np.int32),
        patch_batch=np.empty(arrivals, np.uint8),
        patch_time=np.empty(arrivals, np.float32),
        patch_weight=np.empty(arrivals, np.float32),
        patch_gain=np.empty(arrivals, np.float32),
        cell=np.empty(crossings, np.int64),
        cell_owner=np.empty(crossings, np.int32),
        cell_batch=np.empty(crossings, np.uint8),
        cell_time=np.empty(crossings, np.float32),
        cell_weight=np.empty(crossings, np.float32),
        cell_direction=np.empty((crossings, 3), np.float32),
        filled=np.zeros(3, np.int64),
        ledger=np.zeros(len(LEDGER_NAMES)),
    )


def trimmed(records: Records) -> Records:
    """Return the filled part of the lists."""
    arrivals, crossings = int(records.filled[0]), int(records.filled[1])
    cut = {
        name: column[: arrivals if name.startswith("patch") else crossings]
        for name, column in records._asdict().items()
        if name.startswith(("patch", "cell"))
    }
    return records._replace(**cut)


def overflowed(records: Records) -> bool:
    """Tell whether the lists were too short."""
    return bool(records.filled[0] > len(records.patch) or records.filled[1] > len(records.cell))


@leaf_kernel
def record_arrival(
    records: Records,
    patch: int,
    owner: int,
    batch: int,
    time: float,
    weight: float,
    gain: float,
) -> None:
    """Note a walk that reaches a bottom patch."""
    i = records.filled[0]
    records.filled[0] = i + 1
    if i >= records.patch.shape[0]:
        return
    records.patch[i] = patch
    records.patch_owner[i] = owner
    records.patch_batch[i] = batch
    records.patch_time[i] = time
    records.patch_weight[i] = weight
    records.patch_gain[i] = gain


@leaf_kernel
def record_crossings(
    layers: Layers,
    records: Records,
    owner: int,
    batch: int,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
    length: float,
    weight: float,
    attenuation: float,
    time: float,
    speed: float,
    east_slowness: float,
    north_slowness: float,
) -> None:
    """Note every plane that a straight path of ``length`` crosses, timed at its cell's centre.

    The whole walk is thought shifted sideways to the centre, as light that was launched beside
    it: its time changes by the shift times the slowness [s/m] of the launch along it. Departure:
    crossings within 0.6 degrees of the level are left out, for their weight 1 / |cosine| is without
    bound; within 3 degrees there is 0.2 % of the column's light in coastal water.
    """
    if abs(dz) < FLATTEST:
        return
    first = (layers.top - z) / layers.thickness
    last = (layers.top - z - dz * length) / layers.thickness
    low, high = min(first, last), max(first, last)
    k = max(0, int(np.ceil(low)))
    while k <= high and k < layers.planes:
        along = (layers.top - k * layers.thickness - z) / dz
        px, py = x + dx * along, y + dy * along
        i = int(np.floor((px - layers.west) / layers.cell))
        j = int(np.floor((py - layers.south) / layers.cell))
        if 0 <= i < layers.across and 0 <= j < layers.along and along >= 0.0:
            n = records.filled[1]
            records.filled[1] = n + 1
            if n < records.cell.shape[0]:
                to_x = layers.west + (i + 0.5) * layers.cell - px
                to_y = layers.south + (j + 0.5) * layers.cell - py
                records.cell[n] = (k * layers.along + j) * layers.across + i
                records.cell_owner[n] = owner
                records.cell_batch[n] = batch
                shifted = to_x * east_slowness + to_y * north_slowness
                records.cell_time[n] = time + along / speed + shifted
                records.cell_weight[n] = weight * np.exp(-attenuation * along) / abs(dz)
                records.cell_direction[n, 0] = dx
                records.cell_direction[n, 1] = dy
                records.cell_direction[n, 2] = dz
        k += 1
