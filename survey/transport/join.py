"""Joining forward and backward walks where the light's path is split.

Light that has touched the bottom is split at its last touch: walks of every order meet there on
the same patch. Light of the column is split at its last scattering by more than the split angle.
Every forward batch is paired with every backward batch. The sum over all pairs goes into the fine
bins of the waveform; what the batches say apart, from which the error is told, into coarse ones.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from survey.transport.random import COLUMN_PAIRS, start_stream, uniform
from survey.transport.records import Records
from terrain.kernels import kernel, leaf_kernel

COLUMN, BOTTOM = 0, 1
FORWARD, BACKWARD, MATCHED = 0, 1, 2


class TimeBins(NamedTuple):
    """Evenly spaced bins, named by the first one's early edge."""

    start: float
    width: float
    number: int


class Echoes(NamedTuple):
    """What the pairs add up to, column and bottom (``origin``) apart.

    ``mean`` (2, pixels, bins) is the mean over all pairs of batches. ``batches`` (3, batches, 2,
    pixels, coarse bins) holds for each forward batch its mean over the backward ones; the same
    the other way round; and forward batches with the backward batch of the same number alone.
    A coarse bin has ``coarse`` fine ones.
    """

    mean: NDArray[np.float32]
    batches: NDArray[np.float32]
    coarse: int


@leaf_kernel
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


@leaf_kernel
def deposit_pair(
    echoes: Echoes,
    origin: int,
    pixel: int,
    bins: TimeBins,
    forward_batch: int,
    backward_batch: int,
    time: float,
    photons: float,
) -> None:
    """Add one pair, shared between the two bins whose centres enclose its time."""
    place = (time - bins.start) / bins.width - 0.5
    low = int(np.floor(place))
    if not 0 <= low < bins.number - 1:
        return
    batches = echoes.batches.shape[1]
    late = photons * (place - low)
    share = 1.0 / (batches * batches)
    echoes.mean[origin, pixel, low] += (photons - late) * share
    echoes.mean[origin, pixel, low + 1] += late * share
    coarse = int(place + 0.5) // echoes.coarse
    echoes.batches[FORWARD, forward_batch, origin, pixel, coarse] += photons / batches
    echoes.batches[BACKWARD, backward_batch, origin, pixel, coarse] += photons / batches
    if forward_batch == backward_batch:
        echoes.batches[MATCHED, forward_batch, origin, pixel, coarse] += photons


@leaf_kernel
def join_on_patches(
    echoes: Echoes,
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
    for b in range(backward.patch.shape[0]):
        pixel = backward.patch_owner[b]
        importance = backward.patch_weight[b] * backward.patch_gain[b]
        for k in range(first[b], last[b]):
            f = order[k]
            if isolated and forward.patch_owner[f] != pixel:
                continue
            deposit_pair(
                echoes, BOTTOM, pixel, bins,
                int(forward.patch_batch[f]), int(backward.patch_batch[b]),
                forward.patch_time[f] + backward.patch_time[b],
                importance * forward.patch_weight[f],
            )  # fmt: skip


@kernel
def sorted_by_key(
    cell: NDArray[np.int64], batch: NDArray[np.uint8], cells: int, batches: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return where each cell's and batch's crossings start, and the crossings in that order."""
    start = np.zeros(cells * batches + 1, np.int64)
    for i in range(cell.shape[0]):
        start[cell[i] * batches + np.int64(batch[i]) + 1] += 1
    for key in range(cells * batches):
        start[key + 1] += start[key]
    order = np.empty(cell.shape[0], np.int64)
    filled = start[:-1].copy()
    for i in range(cell.shape[0]):
        key = cell[i] * batches + np.int64(batch[i])
        order[filled[key]] = i
        filled[key] += 1
    return start, order


@leaf_kernel
def turn_density(
    forward: Records,
    f: int,
    backward: Records,
    b: int,
    cosine_table: NDArray[np.float64],
    split_cosine: float,
) -> float:
    """Phase function at the angle between two crossings [1/sr]; 0 within the split angle."""
    to, fro = forward.cell_direction, backward.cell_direction
    cosine = -(to[f, 0] * fro[b, 0] + to[f, 1] * fro[b, 1] + to[f, 2] * fro[b, 2])
    if cosine >= split_cosine:
        return 0.0
    place = max(0.0, 0.5 * (cosine + 1.0) * (cosine_table.shape[0] - 1))
    i = min(int(place), cosine_table.shape[0] - 2)
    return float(cosine_table[i] + (place - i) * (cosine_table[i + 1] - cosine_table[i]))


@kernel
def join_in_column(
    echoes: Echoes,
    bins: TimeBins,
    forward: Records,
    backward: Records,
    cells: int,
    cosine_table: NDArray[np.float64],
    split_cosine: float,
    factor: float,
    isolated: bool,
    seed: int,
    frame: int,
) -> None:
    """Pair crossings of the same cell of a plane: a scattering by more than the split angle.

    ``factor`` is scattering coefficient x layer thickness / cell area. Of each forward batch one
    crossing of the cell is drawn and stands for all of them. No walk has touched the bottom.
    """
    batches = echoes.batches.shape[1]
    start, order = sorted_by_key(forward.cell, forward.cell_batch, cells, batches)
    state = np.empty(2, np.uint64)
    start_stream(state, seed, COLUMN_PAIRS, frame, 0, 0)
    for b in range(backward.cell.shape[0]):
        pixel = backward.cell_owner[b]
        for batch in range(batches):
            key = backward.cell[b] * batches + batch
            present = start[key + 1] - start[key]
            if present == 0:
                continue
            f = order[start[key] + int(uniform(state) * present)]
            if isolated and forward.cell_owner[f] != pixel:
                continue
            density = turn_density(forward, f, backward, b, cosine_table, split_cosine)
            if density == 0.0:
                continue
            deposit_pair(
                echoes, COLUMN, pixel, bins,
                batch, int(backward.cell_batch[b]),
                forward.cell_time[f] + backward.cell_time[b],
                factor * density * present * forward.cell_weight[f] * backward.cell_weight[b],
            )  # fmt: skip
