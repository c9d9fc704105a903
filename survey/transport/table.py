"""Tables that are read between their entries."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from terrain.kernels import inlined_fused_kernel


@inlined_fused_kernel
def value_at(table: NDArray[np.float64], part: float) -> float:
    """Value of a table so far along it, 0 to 1, straight between neighbouring entries."""
    place = part * (table.shape[0] - 1)
    i = min(int(place), table.shape[0] - 2)
    return float(table[i] + (place - i) * (table[i + 1] - table[i]))
