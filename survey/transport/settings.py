"""How much work the Monte Carlo does, and how finely it joins its walks."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class TransportSettings:
    """Numbers of walks and sizes of the places where they are joined.

    Parameters
    ----------
    forward_walks_per_m2 : float
        Walks from the laser per square metre of lit sea surface, all replicates together [1/m2].
    backward_walks_per_pixel : int
        Walks from each pixel to the bottom, all replicates together.
    replicates : int
        Batches of each kind of walk, whose scatter gives the standard error, at least 3.
    split_angle : float
        A scattering in the column by more than this is a turn, where two walks meet [rad].
    patch_size : float
        Longest edge of the bottom patches on which arrivals are paired [m]; a patch is a triangle
        of about half its square.
    layer_thickness : float
        Widest spacing of the planes on which the water column is paired [m]; it is no wider than
        a fifth of the water's attenuation length, within which light decays evenly.
    cell_size : float
        Side of the cells of such a plane [m].
    illumination : {"flood", "isolated"}
        Whether a pixel sees the light launched into every cone or into its own alone.
    forward_column_walks_per_m2 : float
        About how many of the forward walks take part in the water column [1/m2].
    column_walks_per_pixel : int
        Walks from each pixel through the water column, all replicates together.
    """

    forward_walks_per_m2: float = 16.0
    backward_walks_per_pixel: int = 64
    replicates: int = 8
    split_angle: float = radians(30.0)
    patch_size: float = 2.0
    layer_thickness: float = 0.5
    cell_size: float = 2.0
    illumination: Literal["flood", "isolated"] = "flood"
    forward_column_walks_per_m2: float = 8.0
    column_walks_per_pixel: int = 8

    @property
    def backward_walks_per_replicate(self) -> int:
        """Walks from each pixel in one replicate."""
        return max(1, self.backward_walks_per_pixel // self.replicates)

    @property
    def forward_column_stride(self) -> int:
        """One forward walk in this many takes part in the water column."""
        return max(1, round(self.forward_walks_per_m2 / self.forward_column_walks_per_m2))

    @property
    def column_walks_per_replicate(self) -> int:
        """Walks from each pixel through the column in one replicate."""
        return max(1, self.column_walks_per_pixel // self.replicates)
