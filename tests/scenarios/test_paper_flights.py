"""The paper's missions flown whole reach as deep as they should, with few false bottoms."""

from __future__ import annotations

from typing import Any

import pytest

from survey.paper_flights import FLIGHTS, fly_all

pytestmark = [pytest.mark.slow, pytest.mark.timeout(1800)]

# c z where the flooding matrix's ratio falls to 10: `bathyflash paper`, seed 1.
LIMITS = {
    "P02": {"day": 7.1, "night": 9.2},
    "P05": {"day": 11.4, "night": 14.6},
    "P07": {"day": 22.1, "night": 23.4},
}
SEEN_AT_50_M = "p02-flat-night"
BIN = 0.5  # of the depths that a stitched cloud reaches, in whole ones [m]


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    return fly_all(tmp_path_factory.mktemp("flights"), limits=LIMITS)


def test_all_fly(flown: dict[str, dict[str, Any]]) -> None:
    assert list(flown) == [flight.name for flight in FLIGHTS]


@pytest.mark.parametrize("sun", ["day", "night"])
@pytest.mark.parametrize("water", ["p02", "p05", "p07"])
def test_the_stitched_bottom_ends_at_the_threshold_s_depth(
    flown: dict[str, dict[str, Any]], water: str, sun: str
) -> None:
    """Within 4 % or a bin of depth; the Monte Carlo error lets harbor water not near the ratio."""
    row = flown[f"{water}-slope-{sun}"]
    whole_bins = BIN * (row["run_depth_m"] // BIN)
    assert row["stitched_depth_m"] == pytest.approx(whole_bins, rel=0.04, abs=BIN)
    assert (0.88 if water != "p07" else 0.3) < row["stitched_depth_m"] / row["snr_depth_m"] < 1.0


def test_a_level_bottom_at_50_m_is_seen_in_clear_water_at_night_alone(
    flown: dict[str, dict[str, Any]],
) -> None:
    flat = {name: row for name, row in flown.items() if "-flat-" in name}
    assert flat.pop(SEEN_AT_50_M)["found_fraction"] > 0.99
    assert all(row["found_fraction"] < 2e-3 for row in flat.values())


def test_noise_makes_no_more_bottoms_than_allowed(flown: dict[str, dict[str, Any]]) -> None:
    """Where the bottom is hidden, in at least 2,000 pixels: 1 in 1,000, and chance 3 sigma more."""
    for name, row in flown.items():
        if name != SEEN_AT_50_M:
            allowed = row["false_alarm_rate"]
            assert row["hidden_false_fraction"] < allowed + 3.0 * (allowed / 2000.0) ** 0.5, name
