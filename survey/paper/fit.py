"""The receiver that gives the paper's six depths best: two quantities, fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.paper import instrument
from survey.paper.depth_limit import column_limit
from survey.paper.receiver import PaperReceiver

FloatArray = NDArray[np.float64]
Depths = dict[str, dict[str, float]]

GUESS = (0.3, 2e-9)
STEP = 1e-3  # of the numerical derivatives, in the logarithms


@dataclass(frozen=True, kw_only=True)
class Columns:
    """Light of the water columns under one illumination.

    Parameters
    ----------
    depth : array (depths,)
        [m].
    batches : dict of array (batches, depths)
        Power per area of the aperture by the water's name, of independent batches [W/m2].
    """

    depth: FloatArray
    batches: Mapping[str, FloatArray]

    def mean(self) -> dict[str, FloatArray]:
        """Return the mean of all batches."""
        return {name: batches.mean(axis=0) for name, batches in self.batches.items()}

    def leaving_one_out(self) -> list[dict[str, FloatArray]]:
        """Return the means of all batches but one."""
        number = min(map(len, self.batches.values()))
        return [
            {
                name: np.delete(batches, i, axis=0).mean(axis=0)
                for name, batches in self.batches.items()
            }
            for i in range(number)
        ]


@dataclass(frozen=True, kw_only=True)
class Fit:
    """A receiver, and what it makes of the six depths.

    Parameters
    ----------
    receiver : PaperReceiver
    depths : dict
        By sun ("day", "night"), then by water, as read on the paper's axis [m].
    errors : dict
        Their Monte Carlo standard errors, that of the receiver included [m].
    radius_error, width_error : float
        Monte Carlo standard errors of aperture radius and filter width [m].
    """

    receiver: PaperReceiver
    depths: Depths
    errors: Depths
    radius_error: float
    width_error: float

    @property
    def residuals(self) -> Depths:
        """Fitted over published depth, less one [1]."""
        return {
            sun: {name: self.depths[sun][name] / value - 1.0 for name, value in waters.items()}
            for sun, waters in instrument.PUBLISHED.items()
        }

    @property
    def rms(self) -> float:
        """Root mean square of the six residuals [1]."""
        return float(np.sqrt(np.mean(np.square(_flat(self.residuals)))))

    @property
    def worst(self) -> float:
        """The residual farthest from nought [1]."""
        return max(_flat(self.residuals), key=abs)


def fit(columns: Columns, *, reading: float = 1.0) -> Fit:
    """Fit aperture and filter to the six depths, by least squares of the relative residuals.

    The efficiency is assumed: it and the aperture's area enter as a product. Errors are those of
    the jackknife, a whole fit for each batch left out.

    Parameters
    ----------
    columns : Columns
    reading : float
        Depth as the paper's axis shows it over geometric depth: 1, or the refractive index for an
        axis of c t / 2 [1].
    """
    receiver = _fitted(columns.mean(), columns.depth, reading)
    others = []
    for mean in columns.leaving_one_out():
        found = _fitted(mean, columns.depth, reading, guess=receiver)
        depths = six_depths(found, mean, columns.depth, reading=reading)
        others.append([*_flat(depths), found.aperture_radius, found.filter_width])
    *depth_errors, radius_error, width_error = _jackknife_error(np.array(others))
    return Fit(
        receiver=receiver,
        depths=six_depths(receiver, columns.mean(), columns.depth, reading=reading),
        errors=_named(depth_errors),
        radius_error=radius_error,
        width_error=width_error,
    )


def six_depths(
    receiver: PaperReceiver,
    column: Mapping[str, FloatArray],
    depth: FloatArray,
    *,
    reading: float = 1.0,
) -> Depths:
    """Return the depths at which the ratio falls below 10, by sun and water [m]."""
    return {
        sun: {
            name: reading
            * column_limit(
                receiver=receiver,
                depth=depth,
                column=column[name],
                brightness=instrument.SUNS[sun],
            )
            for name in waters
        }
        for sun, waters in instrument.PUBLISHED.items()
    }


def _fitted(
    column: Mapping[str, FloatArray],
    depth: FloatArray,
    reading: float,
    guess: PaperReceiver | None = None,
) -> PaperReceiver:
    from scipy.optimize import least_squares

    published = np.array(_flat(instrument.PUBLISHED))

    def receiver_of(logarithms: FloatArray) -> PaperReceiver:
        radius, width = np.exp(logarithms)
        return PaperReceiver(aperture_radius=float(radius), filter_width=float(width))

    def residuals(logarithms: FloatArray) -> FloatArray:
        found = six_depths(receiver_of(logarithms), column, depth, reading=reading)
        return np.asarray(np.array(_flat(found)) / published - 1.0)

    start = GUESS if guess is None else (guess.aperture_radius, guess.filter_width)
    best = least_squares(residuals, np.log(start), diff_step=[STEP, STEP])
    return receiver_of(best.x)


def _jackknife_error(others: FloatArray) -> list[float]:
    number = len(others)
    spread = others.var(axis=0) * (number - 1)
    return [float(value) for value in np.sqrt(spread)]


def _flat(depths: Mapping[str, Mapping[str, float]]) -> list[float]:
    return [depths[sun][name] for sun, waters in instrument.PUBLISHED.items() for name in waters]


def _named(values: list[float]) -> Depths:
    left = iter(values)
    return {
        sun: {name: next(left) for name in waters} for sun, waters in instrument.PUBLISHED.items()
    }
