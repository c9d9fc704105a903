"""All results of the paper, one after the other."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass

from survey.errors import UserError
from survey.paper import instrument
from survey.paper.fit import Columns, Depths, Fit, fit, six_depths
from survey.paper.light import Light, light_of
from survey.paper.single_element import Sight, compare
from survey.paper.verdict import Verdict, buildable, judge
from survey.transport.response_walks import FLOOD, ISOLATED

LEAST_WORK, MOST_WORK = 0.01, 100.0
STEPS = len(instrument.WATERS) + 1


@dataclass(frozen=True, kw_only=True)
class Findings:
    """What came out.

    Parameters
    ----------
    lights : dict
        Light of each water.
    isolated, flood : Fit
        Fits under either illumination.
    apparent : Fit
        The isolated fit with the paper's axis read as c t / 2.
    flood_same_receiver : dict
        Depths under flood with the receiver of the isolated fit [m].
    buildable_depths : dict
        Depths of an isolated pixel with a receiver that can be built [m].
    verdict : Verdict
        On the receiver of the isolated fit.
    sights : dict
        The matrix and single-element lidars, by contender and water.
    """

    lights: dict[str, Light]
    isolated: Fit
    flood: Fit
    apparent: Fit
    flood_same_receiver: Depths
    buildable_depths: Depths
    verdict: Verdict
    sights: dict[str, dict[str, Sight]]


def reproduce(
    *,
    work: float = 1.0,
    seed: int = 1,
    threads: int = 0,
    tell: Callable[[str], None] = lambda step: None,
) -> Findings:
    """Compute figures 1-3, the six depths and the comparison with a single element.

    Parameters
    ----------
    work : float
        Walks over those of the full computation, 0.01 to 100 [1].
    seed : int
    threads : int
        0 is one for each core; they do not change the results.
    tell : callable
        Takes a line before each of the `STEPS`.

    Raises
    ------
    UserError
        When work lies outside its range.
    """
    if not LEAST_WORK <= work <= MOST_WORK:
        raise UserError(f"paper: --work {work:g}: must lie in {LEAST_WORK:g} to {MOST_WORK:g}")
    lights = {}
    for name, water in instrument.WATERS.items():
        tell(f"light of {name} ({water})")
        lights[name] = light_of(name, work=work, seed=seed, threads=threads or os.cpu_count() or 1)
    tell("receiver, verdict, single element")
    isolated = fit(columns_of(lights, ISOLATED))
    flooded = columns_of(lights, FLOOD)
    narrow = columns_of(lights, ISOLATED)
    return Findings(
        lights=lights,
        isolated=isolated,
        flood=fit(flooded),
        apparent=fit(narrow, reading=instrument.INDEX),
        flood_same_receiver=six_depths(isolated.receiver, flooded.mean(), flooded.depth),
        buildable_depths=six_depths(buildable(), narrow.mean(), narrow.depth),
        verdict=judge(
            isolated.receiver, surface={name: light.surface for name, light in lights.items()}
        ),
        sights=compare(lights, isolated.receiver),
    )


def columns_of(lights: dict[str, Light], illumination: int) -> Columns:
    """Return the water columns of all waters under one illumination."""
    return Columns(
        depth=next(iter(lights.values())).depth,
        batches={name: light.column[:, illumination] for name, light in lights.items()},
    )
