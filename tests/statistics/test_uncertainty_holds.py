"""Over a mission with every effect on, 93 to 97 errors in a hundred lie within the uncertainties."""

from __future__ import annotations

import numpy as np
import pytest

from survey import load_scenario
from survey.cloud.points import PointCloud
from survey.mission import fly_frames
from survey.preparation import prepare
from survey.products.uncertainty_check import uncertainty_metrics

SEEDS = (1, 2, 3)


@pytest.mark.slow
def test_uncertainties_hold_with_every_effect_on() -> None:
    """Three missions: a mission's slow errors of navigation are one draw for many points."""
    found = []
    for seed in SEEDS:
        mission = prepare(load_scenario("every-effect").replace(**{"mission.seed": seed}))
        flown = [result.bottom for _, result, _ in fly_frames(mission, mission.frames)]
        found.append(
            uncertainty_metrics(
                PointCloud.concatenate(flown),
                frames=mission.frames,
                pixel_tangent=mission.camera.pixel_tangent,
                refractive_index=mission.engine.water.refractive_index,
            )
        )
    for name in ("tvu_coverage", "thu_coverage"):
        assert 0.93 < np.mean([each[name] for each in found]) < 0.97, name
