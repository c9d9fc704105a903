"""Handing data to actors."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

COLOUR = "colour"


def feed(actor: Any, data: Any) -> None:
    """Have an actor draw other data.

    Straight to VTK's mapper: the filter that pyvista puts before it may go on giving what it once
    had.
    """
    actor.mapper.SetInputData(data)


def coloured(data: Any, colours: NDArray[np.uint8]) -> Any:
    """Return a data set with colours (n, 3) of its points, sharing all else."""
    painted = data.copy(deep=False)
    painted.point_data[COLOUR] = colours
    painted.set_active_scalars(COLOUR)
    return painted
