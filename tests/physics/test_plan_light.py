"""The light and the depth limits of a plan against the engine and the runs that they foretell."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.expected_light import expected_light
from survey.mission import fly_frame
from survey.optics.response_table import Illumination, response_table
from survey.optics.water import petzold_water
from survey.planning.plan import make_plan
from survey.preparation import prepare
from survey.products.pixels import tallied
from survey.scenario.scenario import Scenario
from survey.transport.response import response

COARSE = {"rows": 8, "columns": 16, "pixel_footprint_m": 8.0}
"""The paper's field of view in 128 pixels: as much light in all, in little time."""

PLUME = {"type": "harbor", "from_depth_m": 0.0, "to_depth_m": 1.5}
SEDIMENT = {
    "from_depth_m": 6.5,
    "absorption_per_m": 0.3,
    "scattering_per_m": 3.0,
    "phase_function": {"kind": "fournier_forand", "backscatter_fraction": 0.02},
}


def scenario(water: str, seabed: dict[str, Any], **changes: Any) -> Scenario:
    tables: dict[str, Any] = {
        "mission": {"title": "a test"},
        "flight": {
            "start_easting_m": 500250.0,
            "start_northing_m": 6000750.0,
            "heading_deg": 90.0,
            "frames_per_line": 1,
        },
        "camera": COARSE,
        "receiver": {"aperture_radius_m": 0.00125, "filter_width_nm": 1.0, "bins": 500},
        "detector": {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1.0e4},
        "water": {"type": water},
        "surface": {"water_level_m": 0.0},
        "seabed": seabed,
    }
    return Scenario.from_tables(tables, name="test.toml", folder=Path()).replace(**changes)


@pytest.mark.parametrize("lit", ["flood", "isolated"])
def test_shipped_tables_are_what_response_computes(lit: str) -> None:
    """False alarms 1e-4: 3.9 standard errors, those of the table being 0.3 % at 4 m or less."""
    which: Illumination = "flood" if lit == "flood" else "isolated"
    water = petzold_water("harbor", refractive_index=1.33, group_index=1.33)
    found = response(water=water, illumination=which, bottom_depth=4.0, seed=77).two_way
    shipped = response_table("harbor", which).two_way_at(np.array([4.0]))[0]
    assert found.sem < 0.02 * found.value
    assert abs(found.value - shipped) < 3.9 * np.hypot(found.sem, 0.003 * shipped)


@pytest.mark.parametrize(("water", "depth"), [("clear", 15.0), ("coastal", 8.0)])
def test_expected_light_is_that_of_the_engine(water: str, depth: float) -> None:
    """Over the same inner half of the frame, around which as much is lit as light reaches."""
    work = {"transport.walks_per_pixel": 256}
    flown = scenario(water, {"kind": "plane", "depth_m": depth}, **work)
    mission, light = prepare(flown), expected_light(flown, height=200.0)
    flash = mission.engine.flash(pose=mission.frames[0].pose, frame=0)
    traced = flash.origin("bottom")[_inner(flash.origin("bottom").shape)].sum(axis=-1)
    foretold = light.bottom(depth=depth, reflectance=0.1)
    foretold = foretold[_inner(foretold.shape)].sum(axis=-1)
    assert traced.std(ddof=1) / traced.size**0.5 < 0.01 * traced.mean()
    assert foretold.mean() / traced.mean() == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize(
    ("water", "depth"),
    [
        ({"type": "clear", "layers": [PLUME]}, 6.0),
        ({"type": "coastal", "layers": [SEDIMENT]}, 8.0),
    ],
)
def test_light_through_layers_is_estimated_from_their_k_d(
    water: dict[str, Any], depth: float
) -> None:
    """To the quarter that `water_response` states; uniform water without the layer is far off."""
    flat = scenario("clear", {"kind": "plane", "depth_m": depth})
    flown = flat.replace(**{"water": water, "transport.walks_per_pixel": 64})
    mission, light = prepare(flown), expected_light(flown, height=200.0)
    flash = mission.engine.flash(pose=mission.frames[0].pose, frame=0)
    traced = flash.origin("bottom")[_inner(flash.origin("bottom").shape)].sum(axis=-1)
    bare = expected_light(flown.replace(**{"water.layers": []}), height=200.0)
    made = [each.bottom(depth=depth, reflectance=0.1) for each in (light, bare)]
    foretold, without = (each[_inner(each.shape)].sum(axis=-1).mean() for each in made)
    assert traced.std(ddof=1) / traced.size**0.5 < 0.02 * traced.mean()
    assert light.water.is_estimate
    assert foretold / traced.mean() == pytest.approx(1.0, abs=0.25)
    assert without / traced.mean() > 1.5


def _inner(shape: tuple[int, ...]) -> tuple[slice, slice]:
    rows, columns = shape[0] // 4, shape[1] // 4
    return slice(rows, -rows), slice(columns, -columns)


@pytest.mark.parametrize(("water", "depth"), [("clear", 24.0), ("coastal", 15.0)])
def test_limits_agree_with_a_run(water: str, depth: float) -> None:
    """Over a slope through the limit: what a plan says of the threshold's run, within 10 %."""
    steep = {"kind": "slope", "depth_m": depth, "slope_deg": 6.0, "downhill_deg": 90.0}
    flown = scenario(water, steep).replace(**{"processing.ranging": "threshold"})
    mission = prepare(flown)
    record = fly_frame(mission, mission.frames[0]).record
    shown = tallied([record]).metrics()["detection_depth_m"]
    foretold = make_plan(flown).expectation
    assert shown is not None
    assert np.nanmin(record.true_depth) + 1.0 < shown < np.nanmax(record.true_depth) - 1.0
    assert foretold.run_day.depth == pytest.approx(shown, rel=0.1)
    assert foretold.day.depth == pytest.approx(shown, rel=0.15)
