"""Times that follow from the flight."""

from __future__ import annotations

from scipy.constants import c

from survey.scenario.sections import Flight, Receiver

GATE_LEAD_NS = 30.0


def gate_start_ns(receiver: Receiver, flight: Flight) -> float:
    """Return when the gate opens after the pulse: as stated, or 30 ns before the nadir surface."""
    if receiver.gate_start_ns is not None:
        return receiver.gate_start_ns
    return max(0.0, two_way_ns(flight.heights_m[0]) - GATE_LEAD_NS)


def two_way_ns(distance_m: float) -> float:
    """Return the time that light takes there and back [ns].

    Examples
    --------
    >>> round(two_way_ns(200.0), 2)
    1334.26
    """
    return 2.0e9 * distance_m / c
