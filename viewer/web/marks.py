"""Which pixels a page shows the waveforms of: few frames, in each some of every outcome."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.products.frame_file import read_frame
from survey.run_folder import frame_path

CANDIDATES = 48
"""So many frames, evenly over the flight, are looked at for rare outcomes."""

PIXELS_A_FRAME = 64

IntArray = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True)
class Marks:
    """Pixels of one frame.

    Parameters
    ----------
    frame : int
    row, column : array (n,)
    """

    frame: int
    row: IntArray
    column: IntArray


def marked_pixels(folder: Path, frames: tuple[int, ...], *, at_least: int) -> list[Marks]:
    """Return pixels to mark, at least so many where the frames have them.

    Parameters
    ----------
    folder : Path
        Of the run.
    frames : tuple of int
        Those of its frames that are whole.
    at_least : int
        Pixels; 64 a frame are taken, or all of a smaller camera.
    """
    looked_at = spread(np.array(frames), CANDIDATES)
    outcomes = [read_frame(frame_path(folder, int(f))).record.outcome for f in looked_at]
    wanted = -(-at_least // min(PIXELS_A_FRAME, outcomes[0].size))
    chosen = telling_frames(np.stack([_counts(outcome) for outcome in outcomes]), wanted)
    each = -(-at_least // len(chosen))
    return [
        _marks(int(looked_at[place]), outcomes[place], min(each, outcomes[place].size))
        for place in chosen
    ]


def spread(values: NDArray[Any], count: int) -> NDArray[Any]:
    """Return at most so many of the values, evenly over them.

    Examples
    --------
    >>> spread(np.arange(10), 4).tolist(), spread(np.arange(2), 4).tolist()
    ([0, 3, 6, 9], [0, 1])
    """
    if len(values) <= count:
        return values
    return values[np.round(np.linspace(0, len(values) - 1, count)).astype(np.intp)]


def telling_frames(counts: NDArray[np.intp], wanted: int) -> list[int]:
    """Return frames, ascending: rare outcomes have one that shows them, the rest lie evenly.

    Parameters
    ----------
    counts : array (frames, outcomes)
        Pixels of every outcome in every frame.
    wanted : int
        How many frames; fewer where there are not so many.

    Examples
    --------
    >>> telling_frames(np.array([[9, 0], [9, 0], [7, 2], [9, 0], [9, 0]]), 3)
    [0, 2, 4]
    """
    chosen: list[int] = []
    for outcome in np.argsort(counts.sum(axis=0)):
        present = counts[:, outcome].any() and not counts[chosen, outcome].any()
        if present and len(chosen) < wanted:
            chosen.append(int(counts[:, outcome].argmax()))
    others = np.setdiff1d(np.arange(len(counts)), chosen)
    return sorted(chosen + spread(others, max(wanted - len(chosen), 0)).tolist())


def shares(counts: NDArray[np.intp], total: int) -> NDArray[np.intp]:
    """Return how many of each kind are taken: equally many, all of what is too rare for that.

    Examples
    --------
    >>> shares(np.array([90, 0, 3]), 20).tolist()
    [17, 0, 3]
    """
    taken, left = np.zeros_like(counts), total
    order = np.argsort(counts, kind="stable")
    for place, kind in enumerate(order):
        taken[kind] = min(counts[kind], left // (len(order) - place))
        left -= taken[kind]
    return taken


def _counts(outcome: NDArray[np.uint8]) -> IntArray:
    return np.bincount(outcome.ravel(), minlength=256)


def _marks(frame: int, outcome: NDArray[np.uint8], count: int) -> Marks:
    """Return pixels of one frame, within an outcome drawn by lot."""
    lot = np.random.default_rng(frame)
    taken = shares(_counts(outcome), count)
    flat = np.sort(
        np.concatenate(
            [
                lot.permutation(np.flatnonzero(outcome.ravel() == kind))[: taken[kind]]
                for kind in np.flatnonzero(taken)
            ]
        )
    )
    row, column = np.unravel_index(flat, outcome.shape)
    return Marks(frame=frame, row=row, column=column)
