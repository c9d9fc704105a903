"""A field of boulders: places by chance, sizes by a stated law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from terrain.extent import MOST_BOULDERS
from terrain.objects import boulder
from terrain.seabed import Seabed

if TYPE_CHECKING:
    import trimesh

FloatArray = NDArray[np.float64]

SUBDIVISIONS = 2


@dataclass(frozen=True, kw_only=True)
class BoulderField:
    """Boulders on a rectangle.

    Their number is Poisson's and their places are independent of each other; diameters follow an
    exponential law above the least, cut off at the largest. Both are what Ditlevsen (2006,
    "A story about distributions of dimensions and locations of boulders", Probabilistic Engineering
    Mechanics 21) found of boulders from glacial till. Departures: no clusters, and boulders may
    touch.

    Parameters
    ----------
    length, width : float
        Along and across the field's heading [m].
    density : float
        Expected number for each square metre [1/m2].
    least_diameter, mean_diameter, largest_diameter : float
        The mean is that of the law before it is cut off [m].
    burial : float
        Part of the diameter under the seabed [1].
    relief : float
        R.m.s. of the radius as a part of it, see `terrain.objects.boulder` [1].
    seed : int

    Raises
    ------
    ValueError
        When a size is not positive, the diameters do not ascend, or too many are expected.
    """

    length: float
    width: float
    density: float
    least_diameter: float
    mean_diameter: float
    largest_diameter: float
    burial: float
    relief: float
    seed: int

    def __post_init__(self) -> None:
        faults = []
        if not (self.length > 0.0 and self.width > 0.0 and self.density > 0.0):
            faults.append("boulders: length, width and density must be positive")
        if not 0.0 < self.least_diameter < self.mean_diameter < self.largest_diameter:
            faults.append("boulders: least, mean and largest diameter must ascend from 0")
        if not 0.0 <= self.burial < 1.0:
            faults.append("boulders: burial must lie between 0 and 1")
        if self.expected > MOST_BOULDERS:
            faults.append(
                f"boulders: {self.expected:.0f} are expected, more than {MOST_BOULDERS}. "
                "take a smaller field or density"
            )
        if faults:
            raise ValueError("\n".join(faults))

    @property
    def expected(self) -> float:
        """Expected number of boulders [1]."""
        return self.length * self.width * self.density

    def draw(self) -> tuple[FloatArray, FloatArray]:
        """Return places (n, 2), along and across from the middle, and diameters (n,) [m]."""
        rng = np.random.Generator(np.random.Philox(key=self.seed))
        count = int(rng.poisson(self.expected))
        places = (rng.random((count, 2)) - 0.5) * [self.length, self.width]
        scale = self.mean_diameter - self.least_diameter
        kept = -np.expm1(-(self.largest_diameter - self.least_diameter) / scale)
        return places, self.least_diameter - scale * np.log1p(-kept * rng.random(count))

    def bodies(
        self, *, seabed: Seabed, east: float, north: float, heading: float = 0.0
    ) -> trimesh.Trimesh:
        """Return all boulders on the seabed, in one mesh in local coordinates.

        Parameters
        ----------
        east, north : float
            Middle of the field in the local frame [m].
        heading : float
            Direction of its length, clockwise from grid north [rad].

        Raises
        ------
        ValueError
            When the field reaches beyond the seabed, or holds no boulder.
        """
        import trimesh

        places, diameters = self.draw()
        if len(places) == 0:
            raise ValueError("boulders: the draw gave none. take a larger field or another seed")
        along = np.array([np.sin(heading), np.cos(heading)])
        across = np.array([np.cos(heading), -np.sin(heading)])
        xy = places @ np.stack([along, across]) + [east, north]
        ground = seabed.elevation_at(xy[:, 0], xy[:, 1])
        if np.isnan(ground).any():
            x, y = xy[np.isnan(ground)][0]
            raise ValueError(
                f"boulders: no seabed at east {x:.1f} m, north {y:.1f} m of the local frame. "
                "move the field or give a larger seabed"
            )
        up = ground + (0.5 - self.burial) * diameters
        rocks = [
            self._rock(number, diameter).apply_translation(place)
            for number, (diameter, place) in enumerate(
                zip(diameters, np.column_stack([xy, up]), strict=True)
            )
        ]
        return cast("trimesh.Trimesh", trimesh.util.concatenate(rocks))

    def _rock(self, number: int, diameter: float) -> trimesh.Trimesh:
        return boulder(
            radius=0.5 * diameter,
            relief=self.relief,
            seed=(self.seed << 20) + number,
            subdivisions=SUBDIVISIONS,
        )
