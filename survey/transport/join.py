"""Joining forward and backward walks at the last turn of the light's path.

Every forward batch is paired with every backward batch. ``echoes`` (2, batches, 2, pixels, bins)
holds, for each forward batch, its mean over the backward ones, and the other way round; then
column and bottom.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.transport.random import COLUMN_PAIRS, start_stream, uniform
from survey.transport.records import Records
from terrain.kernels import kernel

COLUMN, BOTTOM = 0, 1
FORWARD, BACKWARD = 0, 1


class TimeBins(NamedTuple):
    """Evenly spaced bins, named by the first one's early edge."""

    start: float
    width: float
    number: int


@kernel
def deposit(
    histogram: NDArray[np.floating], pixel: int, bins: TimeBins, time: float, photons: float
) -> None:
    """Share photons between the two bins whose centres enclose a time, which keeps the centroid."""
    place = (time - bins.start) / bins.width - 0.5
    low = int(np.floor(place))
    part = place - low
    if 0 <= low < bins.number:
        histogram[pixel, low] += photons * (1.0 - part)
    if 0 <= low + 1 < bins.number:
        histogram[pixel, low + 1] += photons * part


@kernel
def deposit_pair(
    echoes: NDArray[np.float32],
    origin: int,
    pixel: int,
    bins: TimeBins,
    forward_batch: int,
    backward_batch: int,
    time: float,
    photons: float,
) -> None:
    """Add one pair to the estimate of its forward batch and to that of its backward batch."""
    deposit(echoes[FORWARD, forward_batch, origin], pixel, bins, time, photons)
    deposit(echoes[BACKWARD, backward_batch, origin], pixel, bins, time, photons)


@kernel
def join_on_patches(
    echoes: NDArray[np.float32],
    bins: TimeBins,
    forward: Records,
    order: NDArray[np.int64],
    first: NDArray[np.int64],
    last: NDArray[np.int64],
    backward: Records,
    isolated: bool,
) -> None:
    """Pair arrivals on the same patch: a Lambertian turn, weights multiply and times add.

    ``order[first[b]:last[b]]`` are the forward arrivals on the patch of backward arrival b.
    """
    share = 1.0 / echoes.shape[1]
    for b in range(backward.patch.shape[0]):
        pixel = backward.patch_owner[b]
        importance = backward.patch_weight[b] * backward.patch_gain[b] * share
        for k in range(first[b], last[b]):
            f = order[k]
            if isolated and forward.patch_owner[f] != pixel:
                continue
            deposit_pair(
                echoes, BOTTOM, pixel, bins, forward.patch_batch[f], backward.patch_batch[b],
                forward.patch_time[f] + backward.patch_time[b],
                importance * forward.patch_weight[f],
            )  # fmt: skip


@kernel
def sorted_by_cell(
    cell: NDArray[np.int64], cells: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return where each cell's crossings start, and the crossings in the order of cells."""
    start = np.zeros(cells + 1, np.int64)
    for key in cell:
        start[key + 1] += 1
    for key in range(cells):
        start[key + 1] += start[key]
    order = np.empty(cell.shape[0], np.int64)
    filled = start[:-1].copy()
    for i in range(cell.shape[0]):
        order[filled[cell[i]]] = i
        filled[cell[i]] += 1
    return start, order


@kernel
def join_in_column(
    echoes: NDArray[np.float32],
    bins: TimeBins,
    forward: Records,
    backward: Records,
    cells: int,
    cosine_table: NDArray[np.float64],
    split_cosine: float,
    factor: float,
    pairs: int,
    isolated: bool,
    seed: int,
    frame: int,
) -> None:
    """Pair crossings of the same cell of a plane: a scattering by more than the split angle.

    ``factor`` is scattering coefficient x layer thickness / cell area. Of a cell with many forward
    crossings a stratified draw of ``pairs`` stands for all. Light that has touched the bottom
    before counts as bottom.
    """
    share = 1.0 / echoes.shape[1]
    start, order = sorted_by_cell(forward.cell, cells)
    state = np.empty(2, np.uint64)
    start_stream(state, seed, COLUMN_PAIRS, frame, 0, 0)
    entries = cosine_table.shape[0] - 1
    for b in range(backward.cell.shape[0]):
        key = backward.cell[b]
        present = start[key + 1] - start[key]
        drawn = min(present, pairs)
        pixel = backward.cell_owner[b]
        for k in range(drawn):
            pick = k if drawn == present else int((k + uniform(state)) * present / drawn)
            f = order[start[key] + pick]
            if isolated and forward.cell_owner[f] != pixel:
                continue
            cosine = -(
                forward.cell_direction[f, 0] * backward.cell_direction[b, 0]
                + forward.cell_direction[f, 1] * backward.cell_direction[b, 1]
                + forward.cell_direction[f, 2] * backward.cell_direction[b, 2]
            )
            if cosine >= split_cosine:
                continue
            place = max(0.0, 0.5 * (cosine + 1.0) * entries)
            i = min(int(place), entries - 1)
            density = cosine_table[i] + (place - i) * (cosine_table[i + 1] - cosine_table[i])
            photons = factor * density * forward.cell_weight[f] * backward.cell_weight[b]
            photons *= share * present / drawn
            deposit_pair(
                echoes, BOTTOM if forward.cell_touched[f] else COLUMN, pixel, bins,
                forward.cell_batch[f], backward.cell_batch[b],
                forward.cell_time[f] + backward.cell_time[b], photons,
            )  # fmt: skip
