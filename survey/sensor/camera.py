"""The matrix camera: which way each pixel looks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A matrix of pixels, flat in the tangent plane: equal steps on level ground.

    Body axes are forward, right, down. A pixel direction is (f, r, 1) with the tangents f and r.
    Pixel (0, 0) looks forward left, whichever side lies along the flight: with ``long_side =
    "along"`` columns run from forward to aft and rows from left to right; with ``"across"``
    columns run from left to right and rows from forward to aft.

    Parameters
    ----------
    rows, columns : int
        Pixels on the short and on the long side.
    pixel_tangent : float
        Side of a pixel in the tangent plane [1]; 2 m at 250 m is 0.008 [Lisenko2017].
    long_side : {"along", "across"}
        Where the columns run, seen from the flight direction.

    Examples
    --------
    >>> camera = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
    >>> forward, right = camera.pixel_centres()
    >>> float(forward[0, 0]), float(right[0, 0])
    (0.252, -0.124)
    """

    rows: int
    columns: int
    pixel_tangent: float
    long_side: Literal["along", "across"]

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows, self.columns

    @property
    def half_tangents(self) -> tuple[float, float]:
        """Half of the field of view forward and to the right, as tangents [1]."""
        long, short = 0.5 * self.columns * self.pixel_tangent, 0.5 * self.rows * self.pixel_tangent
        return (long, short) if self.long_side == "along" else (short, long)

    def pixel_centres(self) -> tuple[FloatArray, FloatArray]:
        """Return the tangents (forward, right) of the pixel centres, each (rows, columns) [1]."""
        row, column = np.mgrid[0 : self.rows, 0 : self.columns].astype(np.float64)
        from_row = (row + 0.5 - 0.5 * self.rows) * self.pixel_tangent
        from_column = (column + 0.5 - 0.5 * self.columns) * self.pixel_tangent
        if self.long_side == "along":
            return -from_column, from_row
        return -from_row, from_column

    def edge_distances(self, *, height: float) -> FloatArray:
        """Return how far pixel centres are from the nearer edges of the view [m].

        Array (rows, columns, 2) on level ground ``height`` [m] below a level camera, forward or aft
        and to the left or right.

        Examples
        --------
        >>> camera = Camera(rows=2, columns=4, pixel_tangent=0.01, long_side="along")
        >>> camera.edge_distances(height=200.0)[0].round(3).tolist()
        [[1.0, 1.0], [3.0, 1.0], [3.0, 1.0], [1.0, 1.0]]
        """
        centres = np.stack(self.pixel_centres(), axis=-1)
        return np.asarray((self.half_tangents - np.abs(centres)) * height)

    def nearest_pixel(
        self, forward: FloatArray, right: FloatArray
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return row and column of the pixels that look nearest to tangents (forward, right).

        Examples
        --------
        >>> camera = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
        >>> row, column = camera.nearest_pixel(np.array([0.252, -9.0]), np.array([-0.124, 0.0041]))
        >>> row.tolist(), column.tolist()
        ([0, 16], [0, 63])
        """
        along = self.long_side == "along"
        across_rows, across_columns = (right, -forward) if along else (-forward, right)
        row = np.floor(across_rows / self.pixel_tangent + 0.5 * self.rows)
        column = np.floor(across_columns / self.pixel_tangent + 0.5 * self.columns)
        return (
            np.clip(row, 0, self.rows - 1).astype(np.int64),
            np.clip(column, 0, self.columns - 1).astype(np.int64),
        )
