"""Figures of merit on clouds whose errors are known."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import Outcome, PointClass
from survey.optics.water import WaterColumn, petzold_water
from survey.optics.water.apparent import diffuse_attenuation
from survey.products.accuracy import Accuracy
from survey.products.coverage import hull_of
from survey.products.pixels import tallied
from survey.products.reach import reach_sentence

CLEAR, HARBOR = (
    petzold_water(kind, refractive_index=1.34, group_index=1.36) for kind in ("clear", "harbor")
)
WATER = WaterColumn.uniform(CLEAR).with_layer(HARBOR, top=7.0, bottom=7.5)


def judged(survey: Any, *, cell_size: float = 8.0) -> dict[str, Any]:
    """Return the metrics of a survey over its hull."""
    accuracy = Accuracy(
        water_level=survey.water_level, survey_area=hull_of(survey.records), cell_size=cell_size
    )
    odd = survey.bottom.frame % 2 == 1
    accuracy.add(survey.bottom.select(odd), survey.surface)
    accuracy.add(survey.bottom.select(~odd), survey.surface.select(slice(0, 0)))
    return accuracy.metrics(
        pixels=tallied(survey.records), elevation_at=survey.elevation_at, water=WATER
    )


def with_errors(survey: Any, errors: np.ndarray[Any, Any]) -> Any:
    """Return the survey with given elevation errors of the bottom cloud."""
    position = survey.bottom.position.copy()
    position[:, 2] = survey.bottom.true_elevation + errors
    return replace(survey, bottom=replace(survey.bottom, position=position))


def test_known_errors_come_out(small_survey: Any) -> None:
    classes = small_survey.bottom.classification
    errors = np.where(classes == PointClass.BATHYMETRIC, 0.1, -0.3)
    errors[classes == PointClass.NO_BOTTOM_FOUND] = 50.0
    values = judged(with_errors(small_survey, errors))
    assert values["bias_m"] == values["rmse_m"] == values["p95_abs_error_m"] == 0.1
    assert values["ground_bias_m"] == -0.3
    assert values["false_bottoms"] == 0
    assert values["points_bottom"] == (classes == PointClass.BATHYMETRIC).sum()
    assert values["points_ground"] == (classes == PointClass.GROUND).sum()
    assert values["points_no_bottom_found"] == (classes == PointClass.NO_BOTTOM_FOUND).sum()
    assert values["points_surface"] == len(small_survey.surface)
    assert values["frames"] == 32


def test_the_sign_is_measured_less_true(small_survey: Any) -> None:
    too_high = with_errors(small_survey, np.full(len(small_survey.bottom), 0.2))
    assert judged(too_high)["bias_m"] == 0.2


def test_objects_count_as_bottom(small_survey: Any) -> None:
    classes = small_survey.bottom.classification.copy()
    classes[classes == PointClass.BATHYMETRIC] = PointClass.SUBMERGED_OBJECT
    objects = replace(small_survey, bottom=replace(small_survey.bottom, classification=classes))
    assert judged(objects) == judged(small_survey)


def test_false_bottoms_lie_more_than_a_metre_off(small_survey: Any) -> None:
    bottom = np.flatnonzero(small_survey.bottom.classification == PointClass.BATHYMETRIC)
    errors = np.zeros(len(small_survey.bottom))
    errors[bottom[:3]] = [1.01, -4.0, 0.99]
    assert judged(with_errors(small_survey, errors))["false_bottoms"] == 2


def test_points_without_truth_are_left_out(small_survey: Any) -> None:
    elevation = small_survey.bottom.true_elevation.copy()
    elevation[::2] = np.nan
    unknown = replace(small_survey, bottom=replace(small_survey.bottom, true_elevation=elevation))
    values = judged(unknown)
    assert abs(values["bias_m"]) < 0.01
    assert values["points_bottom"] == judged(small_survey)["points_bottom"]


def test_standard_error_counts_frames_not_points(small_survey: Any) -> None:
    """Frames 0.1 m high or low in turn: the mean of 32 such is known to 0.1 / sqrt(31) m."""
    shift = np.where(small_survey.bottom.frame % 2 == 0, 0.1, -0.1)
    values = judged(with_errors(small_survey, shift))
    assert values["bias_standard_error_m"] == pytest.approx(0.1 / np.sqrt(29.0), rel=0.1)


def test_full_coverage_and_half_of_it(small_survey: Any) -> None:
    values = judged(small_survey)
    assert values["coverage_fraction"] > 0.95
    along = small_survey.bottom.position[:, 0]
    depth = small_survey.bottom.true_elevation < small_survey.water_level
    half = small_survey.bottom.select(along < np.median(along[depth]))
    halved = judged(replace(small_survey, bottom=half))
    assert halved["coverage_fraction"] == pytest.approx(0.5, abs=0.05)
    assert halved["density_per_m2"] == pytest.approx(0.5 * values["density_per_m2"], rel=0.05)


def test_points_on_land_do_not_cover_water(small_survey: Any) -> None:
    bottom = small_survey.bottom
    classes = np.full_like(bottom.classification, PointClass.BATHYMETRIC)
    all_wet = replace(small_survey, bottom=replace(bottom, classification=classes))
    assert judged(all_wet)["coverage_fraction"] <= 1.0


def test_density_of_one_line(survey_of: Any) -> None:
    """128 pixels share 102.4 m x 51.2 m; on 100 m of track lie 2.4 % more."""
    values = judged(survey_of(lines=1))
    wet_share = values["points_bottom"] / values["pixels_wet"]
    assert values["density_per_m2"] == pytest.approx(wet_share * 128.0 / (100.0 * 51.2), rel=0.2)


def test_pixels_by_outcome(small_survey: Any) -> None:
    values = tallied(small_survey.records).metrics()
    outcome = np.array([record.outcome for record in small_survey.records])
    weak = int((outcome == Outcome.TOO_WEAK).sum())
    assert values["missed"]["too_weak"] == weak > 0
    assert sum(values["missed"].values()) == weak
    assert set(values["missed"]).isdisjoint({"found", "dry"})
    assert values["pixels_wet"] == (outcome != Outcome.DRY).sum()
    assert values["found_fraction"] == 1.0 - weak / values["pixels_wet"]
    assert values["monte_carlo_relative_error"] == 0.07


def test_detection_depth(small_survey: Any) -> None:
    """The made survey detects with 0.99 down to 7 m and with 0.85 below."""
    values = tallied(small_survey.records).metrics()
    assert values["detection_depth_m"] == 7.0
    assert values["found_fraction_where_detectable"] == 1.0
    assert values["found_fraction_above_detection_depth"] == 1.0


def test_how_deep_the_bottom_was_found(small_survey: Any) -> None:
    """19 pixels in 20 down to 7 m, 13 down to 8 m, 7 below."""
    records = []
    for record in small_survey.records:
        depth = record.true_depth
        found = np.select([depth < 7.0, depth < 8.0], [19, 13], 7)
        missed = np.arange(depth.size).reshape(depth.shape) % 20 >= found
        outcome = np.where(missed, Outcome.TOO_WEAK, Outcome.FOUND).astype(np.uint8)
        records.append(replace(record, outcome=outcome))
    values = judged(replace(small_survey, records=records))
    assert values["found_depth_m"] == values["detection_depth_m"] == 7.0
    assert values["half_found_depth_m"] == 8.0
    assert values["found_depth_c_z"] == values["detection_depth_c_z"] == 7.0 * 0.151
    layered = 7.5 * diffuse_attenuation(CLEAR) + 0.5 * diffuse_attenuation(HARBOR)
    assert values["half_found_depth_k_d_z"] == pytest.approx(layered, abs=1e-6)
    assert "found the bottom down to 7.0 m (c z 1.1, K_d z 0.8)" in reach_sentence(values)


def test_no_depth_where_nothing_was_found(small_survey: Any) -> None:
    records = [
        replace(record, outcome=np.full_like(record.outcome, Outcome.FALSE_BOTTOM))
        for record in small_survey.records
    ]
    values = judged(replace(small_survey, records=records))
    assert values["found_depth_m"] is values["half_found_depth_c_z"] is None
    clear = 7.0 * diffuse_attenuation(CLEAR)
    assert values["detection_depth_k_d_z"] == pytest.approx(clear, abs=1e-6)
    assert "found the bottom at no depth and one in two at no depth" in reach_sentence(values)


def test_a_miss_in_shallow_water_is_counted(small_survey: Any) -> None:
    records = list(small_survey.records)
    shallow = records[2].outcome.copy()
    shallow[:] = Outcome.MERGED_WITH_SURFACE
    records[2] = replace(records[2], outcome=shallow)
    values = tallied(records).metrics()
    assert values["missed"]["merged_with_surface"] == 128
    assert values["found_fraction_above_detection_depth"] < 1.0


def test_nothing_found_is_null_not_nan(small_survey: Any) -> None:
    nothing = small_survey.bottom.select(np.zeros(0, dtype=np.intp))
    values = judged(replace(small_survey, bottom=nothing, surface=nothing))
    json.dumps(values, allow_nan=False)
    assert values["bias_m"] is None
    assert values["surface_rmse_m"] is None
    assert values["points_bottom"] == 0
    assert values["coverage_fraction"] == 0.0


@pytest.mark.parametrize(
    ("outcome", "words"),
    [(Outcome.TOO_WEAK, "too deep or too turbid"), (Outcome.OUTSIDE_GATE, "outside the receiv")],
)
def test_an_empty_cloud_is_explained(small_survey: Any, outcome: Outcome, words: str) -> None:
    record = small_survey.records[5]
    missed = replace(record, outcome=np.full_like(record.outcome, outcome))
    assert words in tallied([missed]).explain_empty()
    assert "100 % of 128 wet pixels" in tallied([missed]).explain_empty()


def test_land_alone_is_explained(small_survey: Any) -> None:
    record = small_survey.records[0]
    dry = replace(record, true_depth=np.full_like(record.true_depth, -1.0))
    assert "no pixel looks at water" in tallied([dry]).explain_empty()
