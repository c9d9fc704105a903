"""Turns from one survey line to the next."""

from __future__ import annotations

from math import acos, atan2, cos, hypot, inf, pi, sin, sqrt, tan

from scipy.constants import g

FULL_TURN = 2.0 * pi

Way = tuple[float, float, float]


def turn_radius(*, speed: float, bank: float) -> float:
    """Return the radius of a level coordinated turn, v^2 / (g tan bank) [m].

    Examples
    --------
    >>> from math import radians
    >>> round(turn_radius(speed=100.0, bank=radians(25.0)))
    2187
    """
    return speed**2 / (g * tan(bank))


def shortest_turn(*, start: Way, end: Way, radius: float) -> float:
    """Return the length of the shortest way from one line to another [m].

    Arcs of one radius, joined by straight lines or by a third arc (Dubins 1957, in the normal
    form of Shkel and Lumelsky 2001, equations 12 to 24).

    Parameters
    ----------
    start, end : tuple of float
        Easting, northing [m] and course, clockwise from grid north [rad].
    radius : float
        Of the arcs [m].

    Examples
    --------
    Lines four radii apart: a quarter turn, two radii straight on, another quarter turn.

    >>> round(shortest_turn(start=(0.0, 0.0, 0.0), end=(4.0, 0.0, pi), radius=1.0) - pi, 9)
    2.0
    """
    east, north = end[0] - start[0], end[1] - start[1]
    d = hypot(east, north) / radius
    bearing = atan2(north, east)
    a = (0.5 * pi - start[2] - bearing) % FULL_TURN
    b = (0.5 * pi - end[2] - bearing) % FULL_TURN
    mirrored = _left_first(-a % FULL_TURN, -b % FULL_TURN, d)
    return radius * min(_left_first(a, b, d), mirrored)


def _left_first(a: float, b: float, d: float) -> float:
    """Return the shortest way that begins with a left turn, in radii; inf where there is none.

    ``a`` and ``b`` are the directions of start and end, counter-clockwise from the line that joins
    them, ``d`` its length. The ways that begin with a right turn are those of the mirror image.
    """
    return min(_left_straight_left(a, b, d), _left_straight_right(a, b, d), _three_arcs(a, b, d))


def _left_straight_left(a: float, b: float, d: float) -> float:
    along, across = d + sin(a) - sin(b), cos(b) - cos(a)
    middle = atan2(across, along)
    return (middle - a) % FULL_TURN + hypot(along, across) + (b - middle) % FULL_TURN


def _left_straight_right(a: float, b: float, d: float) -> float:
    along, across = d + sin(a) + sin(b), -cos(a) - cos(b)
    square = along**2 + across**2 - 4.0
    if square < 0.0:
        return inf
    straight = sqrt(square)
    middle = atan2(across, along) - atan2(-2.0, straight)
    return (middle - a) % FULL_TURN + straight + (middle - b) % FULL_TURN


def _three_arcs(a: float, b: float, d: float) -> float:
    along, across = d + sin(a) - sin(b), cos(b) - cos(a)
    cosine = 1.0 - (along**2 + across**2) / 8.0
    if abs(cosine) > 1.0:
        return inf
    arc = FULL_TURN - acos(cosine)
    first = (atan2(across, along) - a + 0.5 * arc) % FULL_TURN
    return first + arc + (b - a - first + arc) % FULL_TURN
