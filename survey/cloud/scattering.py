"""What scattered light does to a point: it comes late, and from nearer to nadir."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from survey.cloud.echo import Echo

FloatArray = NDArray[np.float64]

ANGLES = 16
OUTLIERS = 4.0  # deviations, from quartiles: merged with the surface, or false
NARROWEST = 1e-3  # rim, also where a point is told above the water [m]
TABLE_REFLECTANCE = 0.15  # assumed: sand, of the level bottoms
FAINTEST = 0.25  # bottom whose brightness is told, over that of the table's
LEAST_NEARNESS = 0.1  # of the outermost pixels: of less, nothing is told of the rim
GROWING = ("depth", "bias", "bias_slant", "bias_rim", "shift")
RIM_PER_DEPTH = 0.25
"""Width of the rim, in depths, whose pixels miss light scattered from beyond the view.

Fitted to flashes in coastal water: what they miss falls to 1 / e within 0.25 of 6 and of 17 m.
"""


@dataclass(frozen=True, kw_only=True)
class LevelBottom:
    """What the expected light of a flash over a level bottom is measured to be; n pixels.

    Parameters
    ----------
    depth : float
        Of the bottom [m].
    tangent : array (n,)
        Of the angles off nadir in air [1].
    error : array (n,)
        Measured less true elevation [m].
    edge : array (n, 2)
        Distances from where pixels look on the water to the edges of the view [m].
    along : array (n,)
        Tangents along one axis of the camera [1].
    origin : array (n,)
        Mean place along that axis where the light was reflected, less that which the pixel's
        centre looks at [m].
    surface_late : array (n,)
        Time of the first echo less that of the water [s].
    brightness : array (n,)
        Of a second bottom there, whose reflectance is uneven, over that of this one [1].
    second_error : array (n,)
        The error over that one [m]; nan where it shows no echo.
    told : array (n,)
        Counts of that one's echo over those of this one's [1].
    """

    depth: float
    tangent: FloatArray
    error: FloatArray
    edge: FloatArray
    along: FloatArray
    origin: FloatArray
    surface_late: FloatArray
    brightness: FloatArray
    second_error: FloatArray
    told: FloatArray


@dataclass(frozen=True, kw_only=True)
class Scattering:
    """Expected errors by measured depth; arrays (depths,).

    The water under a bottom sends nothing back, but what is taken off the counts holds its light:
    an echo seems the earlier, the fainter it is beside that light. Hence an error in proportion to
    1 / reflectance, and counts that tell every bottom darker by the same.

    Parameters
    ----------
    depth : array
        Measured depth [m], growing.
    bias, bias_slant : array
        Measured less true elevation at nadir over a bottom of TABLE_REFLECTANCE, and what the
        squared tangent of the angle off nadir in air adds [m].
    bias_rim : array
        What is added at an edge of the view, beyond which no light is; it falls off inwards as
        `nearness` tells [m].
    bias_bright : array
        What is added over a bottom so bright that the light of the water it hides does not count
        [m]; over one of reflectance r it is 1 - TABLE_REFLECTANCE / r of that.
    hidden : array
        Reflectance that the counts of a bottom miss, for the light of the water it hides [1].
    shift : array
        How much nearer to nadir light was reflected than the pixel's centre looks, over the
        tangent [m].
    residual : array
        Standard deviation of a pixel's elevation about these three [m]: mainly the Monte Carlo
        error of a flash.
    surface_tangent : array (angles,)
        Tangents of angles off nadir, growing [1].
    surface_late : array (angles,)
        How much later than the water the first echo is told there, for light of the water under
        the surface adds to it [s].

    Examples
    --------
    >>> none = Scattering.none()
    >>> none.elevation_error(
    ...     depth=np.array([3.0]), tangent=np.array([0.2]), edge=np.array([[1.0, 9.0]])
    ... ).tolist()
    [0.0]
    """

    depth: FloatArray
    bias: FloatArray
    bias_slant: FloatArray
    bias_rim: FloatArray
    bias_bright: FloatArray
    hidden: FloatArray
    shift: FloatArray
    residual: FloatArray
    surface_tangent: FloatArray
    surface_late: FloatArray

    @classmethod
    def none(cls) -> Scattering:
        """Return what water without scattering does: nothing."""
        return cls(**{field.name: np.zeros(1) for field in fields(cls)})

    @classmethod
    def fitted(cls, bottoms: Sequence[LevelBottom]) -> Scattering:
        """Return the errors over bottoms of growing depth, by least squares over their pixels.

        Above the first of them what light does on its way through the water grows from nothing.
        """
        if not bottoms:
            return cls.none()
        rows = [_fit(bottom) for bottom in bottoms]
        rows.insert(0, rows[0] | dict.fromkeys(GROWING, 0.0))
        tangent, late = _surface(bottoms[-1])
        return cls(
            **{name: np.array([row[name] for row in rows]) for name in rows[0]},
            surface_tangent=tangent,
            surface_late=late,
        )

    def at(self, name: str, depth: FloatArray) -> FloatArray:
        """Return a column at measured depths: straight between the table's, constant beyond."""
        return np.asarray(np.interp(depth, self.depth, getattr(self, name)))

    def elevation_error(
        self, *, depth: FloatArray, tangent: FloatArray, edge: FloatArray
    ) -> FloatArray:
        """Return measured less true elevation that is to be expected [m].

        Parameters
        ----------
        depth : array (...)
            Measured [m].
        tangent : array (...)
            Of the angles off nadir in air [1].
        edge : array (..., 2)
            Distances from where pixels look on the water to the edges of the view [m].
        """
        slant = self.at("bias_slant", depth) * tangent**2
        rim = self.at("bias_rim", depth) * nearness(edge, depth=depth)
        return self.at("bias", depth) + slant + rim

    def error_by_brightness(
        self, *, depth: FloatArray, reflectance: NDArray[np.floating]
    ) -> FloatArray:
        """Return what is added to the error over a bottom of another reflectance [m].

        A quarter of the table's stands for all fainter ones, and for what is not known.

        Examples
        --------
        >>> table = replace(Scattering.none(), bias_bright=np.array([-0.04]))
        >>> table.error_by_brightness(
        ...     depth=np.array(3.0), reflectance=np.array([0.05, 0.1, 0.3])).round(3).tolist()
        [0.08, 0.02, -0.02]
        """
        brightness = np.fmax(reflectance / TABLE_REFLECTANCE, FAINTEST)
        return np.asarray(self.at("bias_bright", depth) * (1.0 - 1.0 / brightness))

    def reflectance(self, told: NDArray[np.floating], *, depth: FloatArray) -> NDArray[np.floating]:
        """Return the reflectances of what counts tell to be darker, at measured depths [1].

        Land, at depth 0, hides no water.

        Examples
        --------
        >>> table = replace(Scattering.none(), hidden=np.array([0.01]))
        >>> table.reflectance(np.array([0.09, 0.3]), depth=np.array([3.0, 0.0])).round(3).tolist()
        [0.1, 0.3]
        """
        return told + np.where(depth > 0.0, self.at("hidden", depth), 0.0)

    def on_time(self, first: Echo, rays: FloatArray) -> Echo:
        """Return first echoes as early as the water is, along rays (rows, columns, 3) in air."""
        late = np.interp(off_nadir(rays), self.surface_tangent, self.surface_late)
        return replace(first, time=first.time - late)

    def corrected(
        self,
        position: FloatArray,
        *,
        rays: FloatArray,
        edge: FloatArray,
        level: float,
        reflectance: Callable[..., FloatArray],
    ) -> FloatArray:
        """Return places in water (..., 3) without the errors to be expected.

        Parameters
        ----------
        position : array (..., 3)
            Measured [m].
        rays : array (..., 3)
            Unit directions from the sensor, in air.
        edge : array (..., 2)
            Distances from where pixels look on the water to the edges of the view [m].
        level : float
            Elevation of the water [m].
        reflectance : callable
            From the keyword ``depth`` (...) [m] to the reflectances that the counts tell there [1].

        Examples
        --------
        >>> table = replace(Scattering.none(), bias=np.array([-0.1]), shift=np.array([0.5]))
        >>> table.corrected(np.array([40.0, 0.0, -5.0]), rays=np.array([0.2, 0.0, -1.0]),
        ...                 edge=np.array([24.0, 32.0]), level=0.0,
        ...                 reflectance=lambda depth: np.array(0.1)).tolist()
        [39.9, 0.0, -4.9]
        """
        depth = level - position[..., 2]
        tangents = rays[..., :2] / -rays[..., 2:]
        error = np.empty_like(position)
        error[..., :2] = self.at("shift", depth)[..., None] * tangents
        error[..., 2] = self.elevation_error(depth=depth, tangent=off_nadir(rays), edge=edge)
        told = self.reflectance(reflectance(depth=depth + error[..., 2]), depth=depth)
        error[..., 2] += self.error_by_brightness(depth=depth, reflectance=told)
        return np.asarray(position - error)


def off_nadir(rays: FloatArray) -> FloatArray:
    """Return the tangents of the angles off nadir of rays (..., 3) [1]."""
    return np.asarray(np.hypot(rays[..., 0], rays[..., 1]) / -rays[..., 2])


def nearness(edge: FloatArray, *, depth: FloatArray | float) -> FloatArray:
    """Return how near the edges are, at distances (..., 2) [m]: 1 on one, 2 in a corner, 0 inside.

    Examples
    --------
    >>> nearness(np.array([[0.0, np.inf], [2.5, 2.5]]), depth=10.0).round(3).tolist()
    [1.0, 0.736]
    """
    width = RIM_PER_DEPTH * np.asarray(depth)[..., None]
    return np.asarray(np.exp(-edge / np.maximum(width, NARROWEST)).sum(axis=-1))


def _surface(bottom: LevelBottom) -> tuple[FloatArray, FloatArray]:
    """Return the median lateness of the first echo by tangent, in classes of equal number."""
    classes = np.array_split(np.argsort(bottom.tangent), ANGLES)
    middle = [[np.median(each[one]) for one in classes] for each in
              (bottom.tangent, bottom.surface_late)]  # fmt: skip
    return np.array(middle[0]), np.array(middle[1])


def _fit(bottom: LevelBottom) -> dict[str, float]:
    """Return a row of the table; outliers of the errors are left out."""
    kept = _usual(bottom.error)
    error = bottom.error[kept]
    near = nearness(bottom.edge, depth=bottom.depth)
    near *= near.max() >= LEAST_NEARNESS
    terms = np.stack([np.ones_like(near), bottom.tangent**2, near], axis=-1)[kept]
    (bias, slant, rim), *_ = np.linalg.lstsq(terms, error)
    return {
        "depth": bottom.depth - float(error.mean()),
        "bias": float(bias),
        "bias_slant": float(slant),
        "bias_rim": float(rim),
        "bias_bright": _bright(bottom),
        "hidden": _hidden(bottom),
        "shift": -float((bottom.along @ bottom.origin) / (bottom.along @ bottom.along)),
        "residual": float((error - terms @ [bias, slant, rim]).std()),
    }


def _bright(bottom: LevelBottom) -> float:
    """Return what is added to the error over a bottom of endless brightness [m]."""
    return _slope(1.0 - 1.0 / bottom.brightness, bottom.second_error - bottom.error, bottom)


def _hidden(bottom: LevelBottom) -> float:
    """Return the reflectance that the counts miss [1].

    Counts that miss a share h of the table's bottom grow from 1 - h to g - h over one g times as
    bright. A detector that saturates tells no share.
    """
    growth = _slope(bottom.brightness - 1.0, bottom.told - 1.0, bottom)
    return TABLE_REFLECTANCE * max(0.0, 1.0 - 1.0 / growth) if growth > 0.0 else 0.0


def _slope(more: FloatArray, change: FloatArray, bottom: LevelBottom) -> float:
    """Return what changes in proportion to what is more over the second bottom; 0 if untold."""
    told = np.isfinite(change) & (bottom.brightness >= FAINTEST)
    if not told.any():
        return 0.0
    more, change = more[told], change[told]
    kept = _usual(change)
    return float(np.linalg.lstsq(more[kept, None], change[kept])[0][0])


def _usual(error: FloatArray) -> NDArray[np.bool_]:
    """Tell which are no outliers."""
    low, middle, high = np.percentile(error, [25.0, 50.0, 75.0])
    return np.asarray(np.abs(error - middle) <= OUTLIERS * max(high - low, 1e-6))
