"""What was found on every kind of bottom."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import BOTTOM_CLASSES, Outcome
from survey.products.frame_file import FrameResult
from survey.products.substrates import SubstrateTally


def results_of(survey: Any) -> list[FrameResult]:
    frames = survey.bottom.frame
    return [
        FrameResult(
            bottom=survey.bottom.select(frames == number),
            surface=survey.surface.select(survey.surface.frame == number),
            record=record,
        )
        for number, record in enumerate(survey.records)
    ]


def judged(bottom: Any, results: list[FrameResult], names: dict[int, str]) -> dict[str, Any]:
    tally = SubstrateTally()
    for result in results:
        tally.add_pixels(result.record, result.bottom.substrate)
    for frame in range(2):
        tally.add_points(bottom.select(bottom.frame % 2 == frame))
    return tally.metrics(names)


def test_every_substrate_has_its_pixels_its_points_and_its_errors(small_survey: Any) -> None:
    bottom = small_survey.bottom
    found = judged(bottom, results_of(small_survey), {1: "sand", 2: "rock"})
    assert list(found) == ["unlabelled", "sand", "rock"]
    depth = np.concatenate([record.true_depth.ravel() for record in small_survey.records])
    outcome = np.concatenate([record.outcome.ravel() for record in small_survey.records])
    for code, values in enumerate(found.values()):
        here = (bottom.substrate == code) & (depth > 0.0)
        solid = (bottom.substrate == code) & np.isin(bottom.classification, BOTTOM_CLASSES)
        error = (bottom.position[:, 2] - bottom.true_elevation)[solid]
        assert values["code"] == code
        assert values["pixels_wet"] == here.sum() > 500
        assert values["found_fraction"] == pytest.approx((outcome[here] == Outcome.FOUND).mean())
        assert values["points_bottom"] == solid.sum()
        assert values["bias_m"] == pytest.approx(error.mean(), abs=1e-6)
        assert values["rmse_m"] == pytest.approx(np.sqrt((error**2).mean()), abs=1e-6)


def test_a_substrate_that_nothing_looks_at_is_left_out(small_survey: Any) -> None:
    results = results_of(small_survey)
    results = [
        replace(r, bottom=replace(r.bottom, substrate=np.full_like(r.bottom.substrate, 7)))
        for r in results
    ]
    nothing = small_survey.bottom.select(np.zeros(len(small_survey.bottom), dtype=bool))
    found = judged(nothing, results, {7: "steel", 8: "concrete"})
    assert list(found) == ["steel"]
    assert found["steel"]["points_bottom"] == 0
    assert found["steel"]["bias_m"] is None
