"""The section [surface] with waves: from keys to a sea, and every fault told."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.scenario import Scenario, ScenarioError, components
from terrain.waves import WaveLattice

JONSWAP = {"spectrum": "jonswap", "fetch_km": 20.0, "patch_m": 128.0}
FULL = {"spectrum": "pierson_moskowitz", "patch_m": 128.0}
SWELL = {"height_m": 1.0, "period_s": 10.0, "from_deg": 270.0}


@pytest.fixture
def make(tables: dict[str, Any], tmp_path: Path) -> Any:
    """Return the maker of scenarios with another sea, and other sections."""

    def made(seed: int = 1, camera: dict[str, Any] | None = None, **surface: Any) -> Scenario:
        changed = {**tables, "surface": {"water_level_m": 0.5, **surface}}
        changed["mission"] = {**tables["mission"], "seed": seed}
        changed["camera"] = camera or {"rows": 8, "columns": 16}
        return Scenario.from_tables(changed, name="reef.toml", folder=tmp_path)

    return made


def lattice_of(scenario: Scenario, *, time: float = 0.0) -> WaveLattice:
    sea = components.sea_surface(scenario)
    assert sea.waves is not None
    return sea.waves.lattice(
        time=time, level=sea.level, west=-30.0, east=30.0, south=-20.0, north=20.0
    )


def test_without_waves_the_sea_is_level(make: Any) -> None:
    sea = components.sea_surface(make())
    assert sea.waves is None
    assert sea.whitecap_coverage == 0.0
    assert sea.remaining_slope_variance == (
        sea.upwind_slope_variance,
        sea.crosswind_slope_variance,
    )


def test_keys_become_a_sea(make: Any) -> None:
    """Height of both, swell of 1 m and a sea of U = 6 m/s in fetch; its waves before the wind."""
    scenario = make(
        wind_speed_m_s=6.0, wind_from_deg=90.0, waves=JONSWAP, swell=[SWELL], whitecaps=True
    )
    sea = components.sea_surface(scenario)
    assert sea.waves is not None
    alone = components.sea_surface(make(wind_speed_m_s=6.0, waves=JONSWAP)).waves
    assert alone is not None
    assert 0.3 < alone.significant_height < 0.7
    assert sea.waves.significant_height == pytest.approx(np.hypot(alone.significant_height, 1.0))
    assert sea.waves.wind_slope_covariance[0, 0] > sea.waves.wind_slope_covariance[1, 1]
    assert sea.whitecap_coverage == pytest.approx(2.95e-6 * 6.0**3.52)
    assert lattice_of(scenario).level == 0.5


def test_swell_alone_and_waves_over_shallow_water(make: Any) -> None:
    swell = components.sea_surface(make(swell=[SWELL, SWELL])).waves
    assert swell is not None
    assert swell.significant_height == pytest.approx(2.0**0.5)
    full = components.sea_surface(make(waves=FULL)).waves
    low = components.sea_surface(make(waves=FULL, wave_depth_m=3.0)).waves
    assert full is not None
    assert low is not None
    assert low.significant_height < full.significant_height


def test_one_realisation_a_seed_that_moves(make: Any) -> None:
    first, again, other = (lattice_of(make(seed=seed, waves=FULL)) for seed in (1, 1, 2))
    assert np.array_equal(first.coefficients, again.coefficients)
    assert not np.array_equal(first.coefficients, other.coefficients)
    later = lattice_of(make(waves=FULL), time=1.0)
    assert not np.array_equal(first.coefficients, later.coefficients)


def test_resolved_scenarios_hold_the_waves(make: Any, tmp_path: Path) -> None:
    scenario = make(waves=JONSWAP, swell=[SWELL])
    tables = tomllib.loads(scenario.to_toml())
    assert tables["surface"]["waves"] == {**JONSWAP, "shortest_m": 2.0}
    assert tables["surface"]["swell"] == [SWELL]
    again = Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)
    assert again.surface == scenario.surface


@pytest.mark.parametrize(
    ("surface", "line"),
    [
        (
            {"waves": {"spectrum": "phillips"}},
            "surface.waves.spectrum: 'phillips' is not one of pierson_moskowitz, jonswap.",
        ),
        ({"waves": {"fetch_km": 3.0}}, "surface.waves.spectrum: missing. Give it a value."),
        (
            {"waves": {**FULL, "patch": 3.0}},
            "surface.waves.patch: unknown key. Did you mean 'patch_m'?",
        ),
        (
            {"waves": {"spectrum": "jonswap"}},
            'surface.waves.fetch_km: missing. It goes with spectrum = "jonswap".',
        ),
        (
            {"waves": {**FULL, "fetch_km": 3.0}},
            'surface.waves.fetch_km: spectrum = "pierson_moskowitz" has no use for it. '
            'Take "jonswap" or leave it out.',
        ),
        (
            {"waves": FULL, "wind_speed_m_s": 0.0},
            "surface.waves: no wind, no waves of it. Give wind_speed_m_s or take swell.",
        ),
        (
            {"waves": FULL, "wind_speed_m_s": 12.0},
            "surface.waves.patch_m: waves of 138 m at the peak do not fit twice into the patch of "
            "128 m. Enlarge the patch.",
        ),
        (
            {"waves": {**FULL, "shortest_m": 0.5, "patch_m": 2048.0}},
            "surface.waves.shortest_m: waves of 0.5 m on a patch of 2048 m take more than 4096 "
            "nodes a side. Take 2 m or a smaller patch.",
        ),
        (
            {"waves": {**FULL, "patch_m": 80.0}, "camera": {"rows": 32, "columns": 64}},
            "surface.waves.patch_m: waves repeat after 80 m, in a frame of 102 m. Enlarge it.",
        ),
        (
            {"swell": [SWELL, {**SWELL, "period_s": 1.1}]},
            "surface.swell.1.period_s: 1.1 s make waves of 1.9 m, shorter than the shortest "
            "resolved, 2 m. Take a longer period.",
        ),
        (
            {"swell": [{**SWELL, "period_s": 3.0, "height_m": 2.5}]},
            "surface.swell.0.height_m: 2.5 breaks: waves of 3 s, 14 m long, stand up to 2 m. "
            "Lower it.",
        ),
        (
            {"swell": [{**SWELL, "height_m": 3.0}], "wave_depth_m": 3.0},
            "surface.swell.0.height_m: 3 breaks: waves of 10 s, 53 m long, stand up to 2.6 m. "
            "Lower it.",
        ),
    ],
)
def test_faults(make: Any, surface: dict[str, Any], line: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        make(**surface)
    assert f"reef.toml: {line}" in caught.value.lines


def test_all_faults_at_once(make: Any) -> None:
    with pytest.raises(ScenarioError) as caught:
        make(
            waves={**FULL, "fetch_km": 1.0, "patch_m": 60.0},
            wind_speed_m_s=10.0,
            swell=[{**SWELL, "height_m": 40.0}],
            camera={"rows": 32, "columns": 64},
        )
    assert len(caught.value.lines) == 4
