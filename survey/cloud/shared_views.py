"""Which frames look at a place under water, as their measured poses say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from survey.cloud.georeference import bend_at_surface
from survey.flight.polygon import cross
from survey.flight.pose import Frame
from survey.flight.trajectory import FieldOfView

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
Indices = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True)
class SharedViews:
    """Outlines of all frames' views on level planes under level water.

    Parameters
    ----------
    entry : array (frames, 4, 2)
        Where the corners' rays enter the water, around the view [m, local].
    spread : array (frames, 4, 2)
        How far these rays go sideways for each metre of depth [1].
    deepest : float
        Down to where views may meet [m].
    """

    entry: FloatArray
    spread: FloatArray
    deepest: float

    @classmethod
    def of(
        cls,
        frames: Sequence[Frame],
        camera: FieldOfView,
        *,
        level: float,
        refractive_index: float,
        deepest: float,
    ) -> SharedViews:
        """Return the views of some frames.

        Parameters
        ----------
        frames : sequence of Frame
        camera : Camera
        level : float
            Elevation of the water [m, local].
        refractive_index : float
            Of the water [1].
        deepest : float
            Down to where views may meet [m].

        Examples
        --------
        >>> from survey.flight.pose import Pose
        >>> from survey.sensor.camera import Camera
        >>> camera = Camera(rows=32, columns=64, pixel_tangent=0.008, long_side="along")
        >>> frames = [Frame(index=i, line=0, time=i, pose=Pose(roll=0.0, pitch=0.0, heading=0.0,
        ...     position=np.array([0.0, 60.0 * i, 200.0]))) for i in range(3)]
        >>> views = SharedViews.of(frames, camera, level=0.0, refractive_index=1.33,
        ...     deepest=10.0)
        >>> views.around(0, most=8).tolist()  # 102 m long: the next, not the third
        [1]
        >>> places = np.array([[0.0, 50.0], [0.0, 0.0]])
        >>> views.see(np.array([1]), places, depth=np.zeros(2), reach=np.ones(2)).tolist()
        [[True, False]]
        """
        forward, right = camera.half_tangents
        corners = np.array([[forward, -right, 1.0], [forward, right, 1.0],
                            [-forward, right, 1.0], [-forward, -right, 1.0]])  # fmt: skip
        corners /= np.linalg.norm(corners, axis=1, keepdims=True)
        turns = np.stack([frame.measured.body_to_map() for frame in frames])
        path = bend_at_surface(
            position=np.stack([frame.measured.position for frame in frames])[:, None],
            rays=np.einsum("fij,rj->fri", turns, corners),
            level=level,
            refractive_index=refractive_index,
        )
        ahead = path.direction
        return cls(
            entry=path.entry[..., :2], spread=ahead[..., :2] / -ahead[..., 2:], deepest=deepest
        )

    def around(self, which: int, *, most: int) -> Indices:
        """Return the frames whose views may meet that of one, in their order.

        Of more than ``most`` those whose centres are nearest.
        """
        low, high = self._boxes
        meets = ((low <= high[which]) & (high >= low[which])).all(axis=1)
        meets[which] = False
        found = np.flatnonzero(meets)
        if len(found) > most:
            centre = self.entry.mean(axis=1)
            apart = np.linalg.norm(centre[found] - centre[which], axis=1)
            found = np.sort(found[np.argsort(apart, kind="stable")[:most]])
        return found

    def any_meet(self) -> bool:
        """Tell whether any two views may meet."""
        everyone = range(len(self.entry))
        return any(self.around(which, most=1).size for which in everyone)

    def see(
        self, which: Indices, places: FloatArray, *, depth: FloatArray, reach: FloatArray
    ) -> BoolArray:
        """Tell which frames' views come near to which places (frames, n).

        Parameters
        ----------
        which : array (frames,)
        places : array (n, 2)
            [m, local].
        depth, reach : array (n,)
            How deep they lie, and what is near [m].
        """
        ring = self.entry[which, None] + self.spread[which, None] * depth[:, None, None]
        edge = np.roll(ring, -1, axis=2) - ring
        apart = places[:, None] - ring
        aside = cross(edge, apart) / np.linalg.norm(edge, axis=-1)
        turn = np.sign(cross(edge, np.roll(edge, -1, axis=2)))
        return np.asarray((aside * turn >= -reach[:, None]).all(axis=-1))

    @cached_property
    def _boxes(self) -> tuple[FloatArray, FloatArray]:
        """Return the least and the greatest corners (frames, 2) of the views."""
        deep = self.entry + self.spread * self.deepest
        both = np.concatenate([self.entry, deep], axis=1)
        return both.min(axis=1), both.max(axis=1)
