"""What pixels truly look at, and what became of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import trimesh
from scipy.constants import speed_of_light

from survey.cloud.points import Outcome, PointClass
from survey.cloud.truth import TrueTargets, outcomes
from terrain.substrate import known_substrates

Looks = Callable[..., Any]


def test_targets_over_a_beach_are_land_and_bed(look_at: Looks) -> None:
    look = look_at(depth=0.0, gradient=0.11, heading_deg=90.0)
    targets, sensor = look.targets, look.frame.pose.position
    dry = targets.classification == PointClass.GROUND
    assert 500 < dry.sum() < 1500
    assert np.all(dry == (targets.depth < 0.0))
    assert np.array_equal(targets.surface[dry], targets.position[dry])
    assert np.abs(targets.surface[~dry][:, 2] - 0.4).max() < 1e-12
    bed = -0.11 * (targets.position[..., 0] - 30.0)
    assert np.abs(targets.position[..., 2] - bed).max() < 1e-9
    way = targets.position[dry] - sensor
    assert np.cross(way, look.rays[dry]) == pytest.approx(0.0, abs=1e-9)
    two_way = 2.0 * np.linalg.norm(way, axis=-1) / speed_of_light
    assert targets.time[dry] == pytest.approx(two_way, rel=1e-14)


def test_targets_on_a_wreck_are_objects(look_at: Looks) -> None:
    bed = look_at(depth=10.0, gradient=0.0).seabed
    box = trimesh.creation.box(extents=(12.0, 12.0, 4.0))
    box.apply_translation([30.0, -20.0, -8.0])
    look = look_at(seabed=bed.with_object(box, reflectance=0.2, source="A box."))
    deck = np.abs(look.targets.position[..., 2] + 6.0) < 1e-9
    side = np.abs(look.targets.position[..., :2] - [30.0, -20.0]).max(axis=-1) <= 6.0 + 1e-9
    hit = look.targets.classification == PointClass.SUBMERGED_OBJECT
    assert 30 < deck.sum() < 80
    assert np.array_equal(hit, side & (look.targets.position[..., 2] > -10.0 + 1e-9))
    assert np.all(hit[deck])
    assert look.targets.depth[deck] == pytest.approx(6.4)


def test_targets_bear_the_label_of_the_face_they_meet_under_water_and_on_land(
    look_at: Looks,
) -> None:
    bed = look_at(depth=0.0, gradient=0.11, heading_deg=90.0).seabed
    box = trimesh.creation.box(extents=(12.0, 12.0, 2.0))
    box.apply_translation([60.0, -20.0, -3.0])
    sand, steel = known_substrates()["sand"], known_substrates()["steel"]
    bed = bed.painted(slice(None), sand).with_object(box, reflectance=0.1, source="A box.")
    bed = bed.painted(bed.is_object, steel)
    targets = look_at(seabed=bed, heading_deg=90.0).targets
    hit = targets.classification == PointClass.SUBMERGED_OBJECT
    assert 20 < hit.sum() < 200
    assert (targets.depth < 0.0).any()
    assert np.all(targets.substrate == np.where(hit, steel.code, sand.code))


def test_a_ray_beside_the_seabed_has_no_target(look_at: Looks) -> None:
    bed = look_at(gradient=0.0).seabed
    mesh = bed.mesh.copy()
    mesh.apply_translation([200.0, 0.0, 0.0])
    targets = look_at(seabed=replace(bed, mesh=mesh), heading_deg=90.0).targets
    beside = np.isnan(targets.depth)
    assert not targets.substrate.any()
    assert 500 < beside.sum() < 1500
    assert np.array_equal(np.isnan(targets.position[..., 2]), beside)
    assert not np.isfinite(targets.time[beside]).any()
    assert np.all(targets.classification == PointClass.BATHYMETRIC)


def one_pixel(depth: float, time: float, kind: PointClass) -> TrueTargets:
    return TrueTargets(
        surface=np.zeros((1, 1, 3)),
        normal=np.zeros((1, 1, 3)),
        position=np.zeros((1, 1, 3)),
        time=np.full((1, 1), time),
        water_path=np.full((1, 1), depth),
        depth=np.full((1, 1), depth),
        classification=np.full((1, 1), kind, np.uint8),
        reflectance=np.full((1, 1), 0.1),
        substrate=np.zeros((1, 1), np.uint8),
    )


WET, LAND = PointClass.BATHYMETRIC, PointClass.GROUND
CASES = [
    # depth, time, class, error, found, saturated, probability, outcome
    (-1.0, 1.4e-6, LAND, np.nan, False, False, 0.0, Outcome.DRY),
    (5.0, 1.4e-6, WET, 0.99, True, False, 0.1, Outcome.FOUND),
    (5.0, 1.4e-6, WET, -0.99, True, True, 0.1, Outcome.FOUND),
    (5.0, 1.4e-6, WET, 1.01, True, False, 0.9, Outcome.FALSE_BOTTOM),
    (5.0, 1.4e-6, WET, -1.01, True, False, 0.9, Outcome.FALSE_BOTTOM),
    (5.0, 1.4e-6, WET, np.nan, True, False, 0.9, Outcome.FALSE_BOTTOM),
    (5.0, 1.4e-6, WET, 5.0, False, True, 0.9, Outcome.SATURATED),
    (5.0, 1.29e-6, WET, 5.0, False, False, 0.9, Outcome.OUTSIDE_GATE),
    (5.0, 1.61e-6, WET, 5.0, False, False, 0.9, Outcome.OUTSIDE_GATE),
    (np.nan, np.inf, WET, np.nan, False, False, 0.0, Outcome.OUTSIDE_GATE),
    (1.1, 1.4e-6, WET, 5.0, False, False, 0.9, Outcome.MERGED_WITH_SURFACE),
    (5.0, 1.4e-6, WET, 5.0, False, False, 0.49, Outcome.TOO_DEEP),
    (5.0, 1.4e-6, WET, 5.0, False, False, 0.51, Outcome.CHANCE),
]


@pytest.mark.parametrize(
    ("depth", "time", "kind", "error", "found", "saturated", "probability", "outcome"), CASES
)
def test_every_pixel_has_the_outcome_that_explains_it(
    depth: float,
    time: float,
    kind: PointClass,
    error: float,
    found: bool,
    saturated: bool,
    probability: float,
    outcome: Outcome,
) -> None:
    assert outcomes(
        targets=one_pixel(depth, time, kind),
        error=np.full((1, 1), error),
        found=np.full((1, 1), found),
        noise=np.full((1, 1), False),
        saturated=np.full((1, 1), saturated),
        probability=np.full((1, 1), probability),
        gate=(1.3e-6, 1.6e-6),
        shallowest=1.2,
    ).tolist() == [[outcome]]
