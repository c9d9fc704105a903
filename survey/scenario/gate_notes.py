"""How deep the receiver's gate sees, where that is not deep enough for the seabed."""

from __future__ import annotations

from collections.abc import Iterator

from survey.scenario import flight_sections as kinds
from survey.scenario.scenario import Scenario
from survey.scenario.seabed_sections import PlaneSeabed
from survey.scenario.times import gate_start_ns, two_way_ns


def gate_notes(scenario: Scenario) -> Iterator[str]:
    """Yield a line when a level seabed lies deeper than the gate sees straight down.

    It is no fault: water without a bottom is what false alarms are measured over.
    """
    seabed, flight, receiver = scenario.seabed, scenario.flight, scenario.receiver
    if not isinstance(seabed, PlaneSeabed) or not isinstance(flight, kinds.PlannedFlight):
        return
    end = gate_start_ns(receiver, flight) + receiver.bins * receiver.bin_width_ns
    depth_ns = two_way_ns(scenario.water.group_index)
    deepest = (end - two_way_ns(flight.heights_m[0])) / depth_ns
    if seabed.depth_m > deepest:
        bins = int((seabed.depth_m - deepest) * depth_ns / receiver.bin_width_ns) + 1
        yield (
            f"the gate closes at {end:.0f} ns, {deepest:.1f} m under the water, above the seabed "
            f"at {seabed.depth_m:g} m: no bottom echo can come. receiver.bins = "
            f"{receiver.bins + bins} would reach it"
        )
