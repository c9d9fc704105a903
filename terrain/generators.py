"""Seabeds from formulas.

Each has a rectangle on the map, an axis through its centre and elevations that depend on the
distance ``s`` along the axis and ``c`` to the right of it. Depths count from the zero of the
vertical datum downwards.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from terrain.extent import MOST_CELLS
from terrain.height_field import triangulate
from terrain.map_frame import MapFrame
from terrain.roughness import Roughness
from terrain.seabed import Seabed, uniform_seabed

FloatArray = NDArray[np.float64]
Profile = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True, kw_only=True)
class Ground:
    """The rectangle a generated seabed covers, and what it is made of.

    Parameters
    ----------
    map_frame : MapFrame
        Local frame.
    centre : (float, float)
        East and north of the centre in the local frame [m].
    length, width : float
        Extent along and across the axis [m].
    axis : float
        Direction of the axis, clockwise from grid north [rad].
    reflectance : float
        Diffuse reflectance of every face, 0 to 1.
    roughness : Roughness, optional
        Synthetic relief added to the shape.
    """

    map_frame: MapFrame
    centre: tuple[float, float] = (0.0, 0.0)
    length: float
    width: float
    axis: float = 0.0
    reflectance: float
    roughness: Roughness | None = None

    def lattice(self, spacing: float) -> tuple[FloatArray, FloatArray, float, float]:
        """Return s (rows, 1) and c (1, cols), and their exact steps, at most ``spacing`` [m]."""
        if not (self.length > 0.0 and self.width > 0.0 and spacing > 0.0):
            raise ValueError("seabed: length, width and spacing must be positive")
        rows, cols = (int(np.ceil(x / spacing - 1e-9)) for x in (self.length, self.width))
        if rows * cols > MOST_CELLS:
            raise ValueError(
                f"seabed: {rows} x {cols} cells of {spacing:g} m are more than {MOST_CELLS:,}. "
                "widen spacing_m, take a smaller margin_m or a shorter flight"
            )
        s = np.linspace(-0.5 * self.length, 0.5 * self.length, rows + 1)[:, None]
        c = np.linspace(-0.5 * self.width, 0.5 * self.width, cols + 1)[None, :]
        return s, c, self.length / rows, self.width / cols

    def along_across(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return how far local places lie along the axis and to the right of it [m]."""
        sine, cosine = np.sin(self.axis), np.cos(self.axis)
        east, north = x - self.centre[0], y - self.centre[1]
        return east * sine + north * cosine, east * cosine - north * sine

    def place(self, s: FloatArray, c: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return local east and north of points along and across the axis [m]."""
        sine, cosine = np.sin(self.axis), np.cos(self.axis)
        return self.centre[0] + s * sine + c * cosine, self.centre[1] + s * cosine - c * sine


def shaped(*, ground: Ground, profile: Profile, spacing: float, sentence: str) -> Seabed:
    """Return the seabed of a formula.

    Parameters
    ----------
    ground : Ground
    profile : callable
        Elevation [m] of places ``s`` (rows, 1) along and ``c`` (1, cols) right of the axis [m].
    spacing : float
        Side of the cells, at most [m].
    sentence : str
        What a product says of the shape.

    Raises
    ------
    ValueError
        When a size is not positive or there are more than 20 million cells.
    """
    s, c, step, _ = ground.lattice(spacing)
    z = np.broadcast_to(profile(s, c), (s.shape[0], c.shape[1])).copy()
    if ground.roughness is not None:
        z += ground.roughness.field((z.shape[0], z.shape[1]), spacing=step)
        sentence = f"{sentence} {ground.roughness.sentence()}"
    return uniform_seabed(
        triangulate(*ground.place(s, c), z),
        reflectance=ground.reflectance,
        map_frame=ground.map_frame,
        source=sentence,
    )


def plane(*, ground: Ground, depth: float, spacing: float | None = None) -> Seabed:
    """Return a level seabed; without ``spacing`` [m] in as few triangles as are near-square.

    Examples
    --------
    >>> frame = MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714)
    >>> ground = Ground(map_frame=frame, length=100.0, width=100.0, reflectance=0.2)
    >>> flat = plane(ground=ground, depth=10.0)
    >>> len(flat.mesh.faces), float(flat.elevation_at(3.0, -4.0))
    (2, -10.0)
    """
    return slope(ground=ground, depth=depth, gradient=0.0, spacing=spacing)


def slope(*, ground: Ground, depth: float, gradient: float, spacing: float | None = None) -> Seabed:
    """Return a seabed ``depth`` [m] deep at the centre that falls by ``gradient`` along the axis.

    A Ground with roughness needs a ``spacing`` [m] (else ValueError).
    """
    if spacing is None:
        if ground.roughness is not None:
            raise ValueError("seabed: roughness needs a spacing. state one")
        spacing = min(ground.length, ground.width)
    return shaped(
        ground=ground,
        profile=lambda s, c: -depth - gradient * s + 0.0 * c,
        spacing=spacing,
        sentence=f"Generated plane, {depth:g} m deep at the centre, gradient {gradient:g}.",
    )


def sandbar(
    *,
    ground: Ground,
    shoreline: float,
    gradient: float,
    bar_distance: float,
    bar_height: float,
    bar_width: float,
    spacing: float,
    beach_gradient: float | None = None,
    beach_height: float | None = None,
) -> Seabed:
    """Return a slope that falls along the axis, with a Gaussian bar along the shore.

    Parameters
    ----------
    shoreline : float
        Distance along the axis at which the slope passes the zero of the vertical datum [m].
    gradient : float
        Fall of the slope seaward [1].
    bar_distance, bar_height, bar_width : float
        Crest seaward of the shoreline, height above the slope, standard deviation [m].
    spacing : float
        Side of the cells [m].
    beach_gradient, beach_height : float, optional
        Rise landward of the shoreline (without it the slope goes on) and where it ends [m].
    """
    rise = gradient if beach_gradient is None else beach_gradient
    crest = np.inf if beach_height is None else beach_height

    def profile(s: FloatArray, c: FloatArray) -> FloatArray:
        out = s - shoreline
        bed = np.where(out > 0.0, -gradient * out, np.minimum(-rise * out, crest))
        bar = bar_height * np.exp(-0.5 * ((out - bar_distance) / bar_width) ** 2)
        return np.asarray(bed + bar + 0.0 * c)

    return shaped(
        ground=ground,
        profile=profile,
        spacing=spacing,
        sentence=f"Generated slope {gradient:g} with a bar {bar_height:g} m high "
        f"{bar_distance:g} m off the shoreline.",
    )


def channel(
    *,
    ground: Ground,
    depth: float,
    channel_depth: float,
    bottom_width: float,
    side_gradient: float,
    spacing: float,
) -> Seabed:
    """Return a level seabed with a channel of trapezoidal section along the axis.

    Parameters
    ----------
    depth, channel_depth : float
        Depth beside and on the floor of the channel [m].
    bottom_width : float
        Width of the floor [m].
    side_gradient : float
        Rise of the sides [1].
    spacing : float
        Side of the cells [m].

    Raises
    ------
    ValueError
        When the channel is no deeper than its surroundings, or a size is not positive.
    """
    if not (channel_depth > depth and side_gradient > 0.0 and bottom_width >= 0.0):
        raise ValueError(
            "seabed: channel: channel_depth must exceed depth, side_gradient be positive"
        )

    def profile(s: FloatArray, c: FloatArray) -> FloatArray:
        rise = side_gradient * np.maximum(np.abs(c) - 0.5 * bottom_width, 0.0)
        return np.asarray(np.minimum(-channel_depth + rise, -depth) + 0.0 * s)

    return shaped(
        ground=ground,
        profile=profile,
        spacing=spacing,
        sentence=f"Generated channel {channel_depth:g} m deep in a seabed {depth:g} m deep.",
    )


def rough(*, ground: Ground, depth: float, spacing: float) -> Seabed:
    """Return a level seabed with the relief of ``ground.roughness`` at cells of ``spacing`` [m].

    Raises ValueError when the ground has no roughness.
    """
    if ground.roughness is None:
        raise ValueError("seabed: rough: the ground has no roughness. state one")
    return plane(ground=ground, depth=depth, spacing=spacing)
