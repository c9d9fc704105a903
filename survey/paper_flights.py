"""The paper's missions flown whole: how deep the stitched bottom reaches, and should reach."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from survey.cloud.points import Outcome
from survey.cloud.stitch import stitched
from survey.mission import fly
from survey.paper import instrument
from survey.paper.reproduce import Findings
from survey.paper.single_element import MATRIX
from survey.planning.expectation import expectation
from survey.preparation import Mission, prepare
from survey.products.accuracy import StitchedDepths
from survey.products.frame_file import FrameResult
from survey.products.reach import optical_depths
from survey.products.writing import ProductError
from survey.run_folder import RunFolder
from survey.scenario import components
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario

SUNS = ("day", "night")
SEAS: Mapping[str, dict[str, Any]] = {
    "slope": {},
    "flat": {
        "seabed": {
            "kind": "plane",
            "depth_m": instrument.BOTTOM_DEPTH,
            "reflectance": instrument.BOTTOM_REFLECTANCE,
        },
        "flight.frames_per_line": 2,  # all look upon the same
    },
}
HIDDEN = 0.01
DIGITS = 4


@dataclass(frozen=True, kw_only=True)
class PaperFlight:
    """One of the twelve.

    Parameters
    ----------
    water : {"P02", "P05", "P07"}
    sun : {"day", "night"}
    sea : {"slope", "flat"}
        The falling bed of the scenario, or the paper's level one at 50 m.
    """

    water: str
    sun: str
    sea: str

    @property
    def name(self) -> str:
        """Name of its run folder."""
        return f"{self.water.lower()}-{self.sea}-{self.sun}"

    def scenario(self, changes: Mapping[str, Any]) -> Scenario:
        """Return its scenario, with further changes by dotted key."""
        own = {"sun.day": self.sun == "day", **SEAS[self.sea]}
        return load_scenario(f"paper-{self.water.lower()}").replace({**own, **changes})


FLIGHTS = tuple(
    PaperFlight(water=water, sun=sun, sea=sea)
    for water, sea, sun in product(instrument.WATERS, SEAS, SUNS)
)


def limits_of(findings: Findings) -> dict[str, dict[str, float]]:
    """Return c z at which the flooding matrix's ratio falls to 10, by water and sun [1]."""
    return {water: sight.limit for water, sight in findings.sights[MATRIX].items()}


def fly_all(
    folder: Path,
    *,
    limits: Mapping[str, Mapping[str, float]],
    flights: Sequence[PaperFlight] = FLIGHTS,
    changes: Mapping[str, Any] | None = None,
    tell: Callable[[str], None] = lambda line: None,
) -> dict[str, dict[str, Any]]:
    """Fly the missions, each into its run folder, and return what `judge` says by their names.

    Flights that an earlier call finished are not flown again.

    Parameters
    ----------
    folder : Path
        Folder of the run folders.
    limits : mapping
        c z at which the flooding matrix's ratio of equation (10) falls to 10, by water and sun [1].
    flights : sequence of PaperFlight
    changes : mapping, optional
        Values of the scenarios by dotted key.
    tell : callable
        Takes a line before each flight.

    Raises
    ------
    OtherRunError
        When a run folder belongs to another scenario or to other code.
    """
    rows, missions = dict[str, dict[str, Any]](), dict[tuple[str, str], Mission]()
    for flight in flights:
        tell(f"flight {flight.name}")
        scenario, light = flight.scenario(changes or {}), (flight.water, flight.sun)
        others = (missions[water, sun] for water, sun in missions if water == flight.water)
        missions[light] = prepare(scenario, alike=missions.get(light) or next(others, None))
        results = _flown(missions[light], scenario, folder / flight.name)
        limit = limits[flight.water][flight.sun]
        rows[flight.name] = judge(scenario, results, limit=limit)
    return rows


def judge(
    scenario: Scenario, results: Sequence[FrameResult], *, limit: float
) -> dict[str, float | None]:
    """Return in plain values what a flight reached beside what was expected of it.

    ====================================  ======================================================
    snr_depth_m                           bottom echo's ratio of equation (10) falls to 10
    threshold_depth_m                     nine flashes in ten reach the threshold of the stated
                                          false-alarm rate, by `survey.planning.expectation`
    run_depth_m                           the same with thresholds raised by the Monte Carlo error
    stitched_depth_m, half_*              see `survey.products.accuracy.StitchedDepths`
    *_c_z, *_k_d_z                        these depths times c and K_d
    true_depth_least_m, _greatest_m       of the bottom under the pixels
    found_fraction                        share of pixels that found the true bottom
    false_bottom_fraction                 share that reported one more than 1 m off
    hidden_false_fraction                 the same of the pixels whose true echo fires in less than
                                          1 % of flashes; None where there are none
    false_alarm_rate                      highest share that noise alone is allowed
    ====================================  ======================================================

    Parameters
    ----------
    scenario : Scenario
    results : sequence of FrameResult
        Of all its frames.
    limit : float
        c z where the ratio of equation (10) should fall to 10 [1].
    """
    water = components.water(scenario)
    level = components.sea_surface(scenario).level
    cloud = stitched([r.bottom for r in results], cell_size=scenario.processing.thinning_m)
    reached = StitchedDepths(water_level=level)
    reached.add(cloud)
    outcome = np.concatenate([r.record.outcome.ravel() for r in results])
    depth = np.concatenate([r.record.true_depth.ravel() for r in results])
    fires = np.concatenate([r.record.detection_probability.ravel() for r in results])
    false = outcome == Outcome.FALSE_BOTTOM
    hidden = fires < HIDDEN
    expected = expectation(
        scenario,
        seabed=components.seabed(scenario),
        height=scenario.flight.height_m - level,
    )
    threshold, run = (
        (expected.day, expected.run_day)
        if scenario.sun.day
        else (expected.night, expected.run_night)
    )
    depths = {
        "snr_depth_m": limit / water.surface.attenuation,
        "threshold_depth_m": threshold.depth,
        "run_depth_m": run.depth,
        **reached.metrics(),
    }
    values = {
        **depths,
        **optical_depths(depths, water),
        "true_depth_least_m": float(depth.min()),
        "true_depth_greatest_m": float(depth.max()),
        "found_fraction": float((outcome == Outcome.FOUND).mean()),
        "false_bottom_fraction": float(false.mean()),
        "hidden_false_fraction": float(false[hidden].mean()) if hidden.any() else None,
        "false_alarm_rate": scenario.processing.false_alarm_rate,
    }
    return {name: None if value is None else round(value, DIGITS) for name, value in values.items()}


def _flown(mission: Mission, scenario: Scenario, folder: Path) -> list[FrameResult]:
    """Fly into a run folder and return all frames; no bottom at all is a result too."""
    with suppress(ProductError):
        fly(scenario, folder, workers=scenario.run.workers, mission=mission)
    run = RunFolder.open(folder, scenario)
    return [run.frame(index) for index in sorted(run.whole)]
