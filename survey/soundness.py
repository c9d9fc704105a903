"""Whether what a flash gave can be true at all."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.products.observation import Observation


class UnsoundFrameError(ArithmeticError):
    """A flash whose numbers are not finite where they must be."""


def sound(seen: Observation) -> Observation:
    """Return an observation as it is.

    Raises
    ------
    UnsoundFrameError
        When light, its variance or a place is not finite: one such number would go unseen into
        medians and grids.
    """
    numbers: dict[str, NDArray[np.floating[Any]]] = {
        "expected light": seen.waveforms.photo_electrons,
        "its variance": seen.waveforms.variance,
        "bottom points": seen.result.bottom.position,
        "surface points": seen.result.surface.position,
    }
    spoilt = [name for name, values in numbers.items() if not np.isfinite(np.sum(values))]
    if spoilt:
        raise UnsoundFrameError(f"frame {seen.frame.index}: not finite: {', '.join(spoilt)}")
    return seen
