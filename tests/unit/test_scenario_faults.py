"""Every fault of a scenario has its line, and all come at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from survey.scenario.faults import ScenarioError
from survey.scenario.scenario import Scenario, with_changes


def faults_of(tables: dict[str, Any], **changes: Any) -> tuple[str, ...]:
    changed = with_changes(tables, changes, name="reef.toml")
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_tables(changed, name="reef.toml", folder=Path())
    return caught.value.lines


@pytest.mark.parametrize(
    ("key", "value", "line"),
    [
        ("water.tpye", "clear", "water.tpye: unknown key. Did you mean 'type'?"),
        (
            "water.depht_m",
            3.0,
            "water.depht_m: unknown key. Did you mean 'depth_m'? It belongs in [seabed].",
        ),
        ("water.water_level_m", 0, "water.water_level_m: unknown key. It belongs in [surface]."),
        ("laser.colour", "green", "laser.colour: unknown key."),
        ("watter.type", "clear", "watter: unknown section. Did you mean 'water'?"),
        (
            "water.type",
            "harbour",
            "water.type: 'harbour' is not one of clear, coastal, harbor, stated, components, "
            "surveyed, profiled. Did you mean 'harbor'?",
        ),
        (
            "seabed.kind",
            "plain",
            "seabed.kind: 'plain' is not one of raster, points, mesh, plane, slope, sandbar, "
            "channel, ripples, reef, rough. Did you mean 'plane'?",
        ),
        ("seabed.kind", None, "seabed.kind: missing. Say which kind it is."),
        ("seabed.depht_m", 3, "seabed.depht_m: unknown key. Did you mean 'depth_m'?"),
        ("seabed.depth_m", True, "seabed.depth_m: true is not a number."),
        ("seabed.depth_m", "10", "seabed.depth_m: '10' is not a number."),
        (
            "flight.height_m",
            -200,
            "flight.height_m: -200 is out of bounds. It must be greater than 0.",
        ),
        ("flight.lines", 2.0, "flight.lines: 2.0 is not a whole number."),
        ("flight.lines", True, "flight.lines: true is not a whole number."),
        (
            "flight.heading_deg",
            360,
            "flight.heading_deg: 360 is out of bounds. It must be less than 360.",
        ),
        (
            "flight.sidelap",
            float("nan"),
            "flight.sidelap: nan is not a finite number. Give it a value.",
        ),
        (
            "surface.water_level_m",
            float("inf"),
            "surface.water_level_m: inf is not a finite number. Give it a value.",
        ),
        ("surface.water_level_m", None, "surface.water_level_m: missing. Give it a value."),
        ("sun.day", 1, "sun.day: 1 is not true or false."),
        ("mission.title", "", "mission.title: the text is empty. Write some or leave the key out."),
        ("laser", 3, "laser: 3 is not a table of keys."),
        (
            "mission.start_utc",
            "today",
            "mission.start_utc: 'today' is not a date and time such as 2026-06-21T10:00:00Z.",
        ),
        (
            "water.group_index",
            1.30,
            "water.group_index: 1.3 is below refractive_index 1.3415. "
            "A pulse in water is slower than its phase; raise it.",
        ),
        (
            "mission.crs_epsg",
            4326,
            "mission.crs_epsg: EPSG:4326 (WGS 84) is not a projected map in "
            "metres. Take one, such as UTM.",
        ),
        (
            "mission.crs_epsg",
            2264,
            "mission.crs_epsg: EPSG:2264 (NAD83 / North Carolina (ftUS)) is "
            "not a projected map in metres. Take one, such as UTM.",
        ),
        ("mission.crs_epsg", 999999, "mission.crs_epsg: there is no EPSG:999999."),
        (
            "mission.vertical_epsg",
            5715,
            "mission.vertical_epsg: EPSG:5715 (MSL depth) is not a height "
            "in metres, positive up. Take one, such as 5714 or 5703.",
        ),
        (
            "receiver.gate_start_ns",
            1400,
            "receiver.gate_start_ns: 1400 is after the water surface's "
            "first echo at 1324 ns. Open earlier.",
        ),
        (
            "receiver.bins",
            90,
            "receiver.bins: the gate closes at 1394 ns, before the corner pixels "
            "see the water surface at 1398 ns. Take at least 94 bins.",
        ),
    ],
)
def test_one_fault_one_line(tables: dict[str, Any], key: str, value: Any, line: str) -> None:
    assert faults_of(tables, **{key: value}) == (f"reef.toml: {line}",)


def test_all_faults_come_at_once_across_sections_and_rules(tables: dict[str, Any]) -> None:
    lines = faults_of(
        tables,
        **{
            "water.depht_m": 1,
            "flight.lines": 0,
            "mission.crs_epsg": 4326,
            "seabed.depth_m": None,
            "detector.quantum_efficiency": 1.5,
        },
    )
    places = {line.split(": ")[1] for line in lines}
    assert places == {
        "water.depht_m",
        "flight.lines",
        "mission.crs_epsg",
        "seabed.depth_m",
        "detector.quantum_efficiency",
    }


def test_an_empty_scenario_names_all_that_must_be_given() -> None:
    places = [line.split(": ")[1] for line in faults_of({})]
    assert "surface.water_level_m" in places
    assert "seabed.kind" in places
    assert "receiver.aperture_radius_m" in places


def test_faults_of_objects_name_the_object(tables: dict[str, Any]) -> None:
    tables["seabed"]["objects"] = [
        {"kind": "wreck", "easting_m": 1, "northing_m": 2, "lenght_m": 3},
        {"kind": "boat"},
        {"kind": "mesh", "easting_m": 1, "northing_m": 2, "file": "no.ply"},
    ]
    assert faults_of(tables) == (
        "reef.toml: seabed.objects.0.lenght_m: unknown key. Did you mean 'length_m'?",
        "reef.toml: seabed.objects.1.kind: 'boat' is not one of wreck, boulder, boulders, "
        "cube, pipeline, mesh.",
    )


def test_a_missing_file_is_told_apart(tables: dict[str, Any]) -> None:
    tables["seabed"] = {"kind": "raster", "file": "no.tif"}
    with pytest.raises(ScenarioError, match=r"seabed.file: no file 'no.tif'") as caught:
        Scenario.from_tables(tables, name="reef.toml", folder=Path())
    assert caught.value.only_missing_files


def test_faults_stay_on_one_line_and_short(tables: dict[str, Any]) -> None:
    tables["water"]["two\nlines"] = 1
    tables["water"]["type"] = "x" * 10_000
    lines = faults_of(tables)
    assert len(lines) == 2
    assert all("\n" not in line and len(line) < 200 for line in lines)
