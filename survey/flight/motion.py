"""How the aircraft moves about its line: shaped noise with a stated spectrum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from survey.flight.plan import unit_axes
from survey.flight.pose import FULL_TURN, Frame

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Swing:
    """Second-order shaped noise: a damped spring driven by white noise.

    x'' + 2 d w x' + w^2 x = white noise, w = 2 pi / period. Its one-sided spectrum is
    rms^2 8 d w^3 / [(w^2 - v^2)^2 + (2 d w v)^2] per hertz at v = 2 pi f.

    Parameters
    ----------
    rms : float
        Root mean square [rad or m].
    period : float
        Of the undamped spring [s].
    damping : float
        Share of the critical damping d [1]: small swings long at its period, from 1 on creeps.
    """

    rms: float
    period: float
    damping: float

    def spectrum(self, frequency: FloatArray) -> FloatArray:
        """Return the one-sided spectral density at frequencies [Hz], rms^2 per hertz."""
        w, v = 2.0 * np.pi / self.period, 2.0 * np.pi * frequency
        form = (w**2 - v**2) ** 2 + (2.0 * self.damping * w * v) ** 2
        return np.asarray(self.rms**2 * 8.0 * self.damping * w**3 / form)

    def drawn(self, times: FloatArray, chance: np.random.Generator) -> FloatArray:
        """Return one realisation at ascending times (n,) [s], exact for steps of any length.

        Place and speed pass from one time to the next by the spring's own motion, and what noise
        adds meanwhile keeps their stationary variances rms^2 and (w rms)^2.
        """
        normal = chance.standard_normal((len(times), 2))
        angle = 2.0 * np.pi / self.period * np.diff(times)
        place, speed = normal[0].tolist()
        result = [place]
        for (a, b, c, d, e, f, g), (first, second) in zip(
            _passages(angle, self.damping).T.tolist(), normal[1:].tolist(), strict=True
        ):
            place, speed = (
                a * place + b * speed + e * first,
                c * place + d * speed + f * first + g * second,
            )
            result.append(place)
        return self.rms * np.array(result)


def _passages(angle: FloatArray, damping: float) -> FloatArray:
    """Return how a unit spring (place, speed) passes on by angles w t (n,), as (7, n).

    The four numbers of the matrix that carries it, by rows, and the three of the lower triangle
    that makes the added noise of independent normal numbers (Cholesky): what is carried and what
    is added have unit variance together.
    """
    root = np.sqrt(complex(1.0 - damping**2))
    forth, back = (np.exp((-damping + sign * 1j * root) * angle) for sign in (1.0, -1.0))
    even = 0.5 * (forth + back).real
    odd = ((forth - back) / (2j * root)).real if root else angle * forth.real
    a, b, c, d = even + damping * odd, odd, -odd, even - damping * odd
    e = np.sqrt(np.maximum(1.0 - a**2 - b**2, 0.0))
    f = np.divide(-(a * c + b * d), e, out=np.zeros_like(e), where=e > 0.0)
    g = np.sqrt(np.maximum(1.0 - c**2 - d**2 - f**2, 0.0))
    return np.array([a, b, c, d, e, f, g])


@dataclass(frozen=True, kw_only=True)
class Motion:
    """The aircraft's motion: means, and sums of swings.

    Parameters
    ----------
    roll_mean, pitch_mean : float
        Trim [rad].
    roll, pitch, heading : tuple of Swing
        About the means, and about the heading of the line [rad].
    cross_track, height : tuple of Swing
        Off the line to the right of the heading, and above its height [m].
    """

    roll_mean: float = 0.0
    pitch_mean: float = 0.0
    roll: tuple[Swing, ...] = ()
    pitch: tuple[Swing, ...] = ()
    heading: tuple[Swing, ...] = ()
    cross_track: tuple[Swing, ...] = ()
    height: tuple[Swing, ...] = ()

    @property
    def is_still(self) -> bool:
        """True where the aircraft does nothing but follow its line."""
        return self == Motion()


CHANNELS = ("roll", "pitch", "heading", "cross_track", "height")
"""The moving parts, each with random numbers of its own."""


def moved(
    frames: Sequence[Frame], motion: Motion, chances: Sequence[np.random.Generator]
) -> list[Frame]:
    """Return the frames as the aircraft truly flies them.

    Parameters
    ----------
    frames : sequence of Frame
        Of `fly_lines`, in the order of flight.
    motion : Motion
    chances : sequence of numpy generators
        One for each of `CHANNELS`, so that changing one motion leaves the others as they were.
    """
    if motion.is_still:
        return list(frames)
    times = np.array([frame.time for frame in frames])
    drawn = {
        name: sum((swing.drawn(times, chance) for swing in getattr(motion, name)), 0.0 * times)
        for name, chance in zip(CHANNELS, chances, strict=True)
    }
    return [
        _moved_one(frame, motion, {name: float(values[i]) for name, values in drawn.items()})
        for i, frame in enumerate(frames)
    ]


def _moved_one(frame: Frame, motion: Motion, by: dict[str, float]) -> Frame:
    pose = frame.pose
    _, right = unit_axes(pose.heading)
    aside = np.array([*(by["cross_track"] * right), by["height"]])
    return replace(
        frame,
        pose=replace(
            pose,
            position=pose.position + aside,
            roll=pose.roll + motion.roll_mean + by["roll"],
            pitch=pose.pitch + motion.pitch_mean + by["pitch"],
            heading=(pose.heading + by["heading"]) % FULL_TURN,
        ),
    )
