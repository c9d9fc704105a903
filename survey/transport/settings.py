"""How much work the Monte Carlo does, and where it splits the light's paths."""

from __future__ import annotations

from dataclasses import dataclass
from math import radians
from typing import Literal


@dataclass(frozen=True, kw_only=True)
class TransportSettings:
    """Numbers of walks, and how light paths are put together.

    Parameters
    ----------
    walks_per_pixel : int
        Light paths of a pixel, all replicates together.
    replicates : int
        Batches of light paths, whose scatter gives the standard error, at least 3.
    tracks_per_replicate : int
        Walks in open water that each replicate draws, for the laser's side and as many for the
        pixels'; all light paths of a flash are laid along them.
    split_angle : float
        A scattering in the column by more than this is a wide turn, where two walks may meet [rad].
    column_spacing : float
        Path between the points where the column is lit, in attenuation lengths 1 / c; they lie by
        turns on the laser's track and on the walk from the pixel [1].
    illumination : {"flood", "isolated"}
        Whether a pixel sees the light launched into every cone or into its own alone.
    """

    walks_per_pixel: int = 64
    replicates: int = 4
    tracks_per_replicate: int = 1024
    split_angle: float = radians(45.0)
    column_spacing: float = 1.0
    illumination: Literal["flood", "isolated"] = "flood"

    @property
    def walks_per_replicate(self) -> int:
        """Light paths of a pixel in one replicate."""
        return max(1, self.walks_per_pixel // self.replicates)
