"""The sections [flight], [motion] and [navigation]: from keys to poses, and every fault told."""

from __future__ import annotations

import json
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.flight.area import AreaPlan
from survey.flight.files.sbet_file import sbet_bytes
from survey.flight.plan import FlightPlan
from survey.flight.track import Track
from survey.flight.trajectory import footprints, require_air
from survey.scenario import Scenario, ScenarioError, components
from survey.scenario.motion_parts import build_motion, build_navigation
from survey.scenario.toml_text import to_toml
from terrain.foreign.faults import ForeignFileError

CORNERS = [[5.0e5, 6.0e6], [5.002e5, 6.0e6], [5.002e5, 6.0006e6], [5.0e5, 6.0006e6]]
RECEIVER = {"aperture_radius_m": 0.005, "filter_width_nm": 1.0}
WIDE_RECEIVER = {**RECEIVER, "gate_start_ns": 1000.0, "bins": 900}


@pytest.fixture
def make(tables: dict[str, Any], tmp_path: Path) -> Any:
    """Return the maker of scenarios with other sections."""

    def made(**sections: Any) -> Scenario:
        changed = {**tables, **sections}
        return Scenario.from_tables(changed, name="reef.toml", folder=tmp_path)

    return made


def faults_of(make: Any, **sections: Any) -> list[str]:
    with pytest.raises(ScenarioError) as caught:
        make(**sections)
    return [line.removeprefix("reef.toml: ") for line in caught.value.lines]


def sbet(folder: Path, *, seconds: float = 10.0, roll_deg: float = 0.0) -> str:
    """Write a level flight towards grid east at 230 m, and return its name."""
    time = np.linspace(0.0, seconds, 51)
    track = Track(
        time=1000.0 + time,
        position=np.column_stack([5e5 + 60.0 * time, np.full(51, 6e6), np.full(51, 230.0)]),
        roll=np.full(51, np.radians(roll_deg)),
        pitch=np.zeros(51),
        heading=np.full(51, np.pi / 2),
    )
    (folder / "track.sbet").write_bytes(sbet_bytes(track, epsg=25832))
    return "track.sbet"


def test_lines_are_still_what_a_flight_is_without_further_keys(make: Any) -> None:
    scenario = make()
    assert scenario.flight.kind == "lines"
    plan = components.flight_plan(scenario)
    assert isinstance(plan, FlightPlan)
    assert components.flight_size(scenario) == "lines x frames: 1 x 2"
    assert all(frame.measured is frame.pose for frame in components.frames(scenario))


def test_corners_alone_make_an_area(make: Any) -> None:
    scenario = make(flight={"corners_m": CORNERS, "heading_deg": 0.0, "cross_lines": 1})
    plan = components.flight_plan(scenario)
    assert isinstance(plan, AreaPlan)
    assert plan.line_count == 6
    assert components.flight_size(scenario) == f"lines: 6, frames: {plan.frame_count}"
    ring = components.survey_area(scenario)
    assert ring is not None
    assert components.map_frame(scenario).origin[:2] + ring == pytest.approx(np.array(CORNERS))
    assert components.seabed(scenario).map_frame == components.map_frame(scenario)


def test_an_area_may_be_closed_as_in_geojson(make: Any) -> None:
    scenario = make(flight={"corners_m": [*CORNERS, CORNERS[0]], "heading_deg": 0.0})
    assert len(components.survey_area(scenario)) == 4  # type: ignore[arg-type]


def test_resolved_scenarios_with_files_fly_the_same(make: Any, tmp_path: Path) -> None:
    name = sbet(tmp_path)
    swings = [{"rms_deg": 1.0, "period_s": 5.0}, {"rms_deg": 0.5, "period_s": 50.0}]
    flown = [
        make(flight={"file": name, "height_m": 229.5}),
        make(
            flight={"corners_m": CORNERS, "heading_deg": 10.0},
            motion={"roll": swings, "height": [{"rms_m": 1.0, "period_s": 20.0}]},
            navigation={"gnss_white_up_m": 0.1, "trajectory_files": ["sbet"]},
            receiver=WIDE_RECEIVER,
        ),
    ]
    for scenario in flown:
        again = Scenario.from_tables(
            tomllib.loads(scenario.to_toml()), name="again.toml", folder=tmp_path
        )
        for one, other in zip(components.frames(scenario), components.frames(again), strict=True):
            assert (one.pose.position == other.pose.position).all()
            assert (one.pose.roll, one.measured.roll) == (other.pose.roll, other.measured.roll)


def test_a_recorded_flight_is_flown_as_recorded(make: Any, tmp_path: Path) -> None:
    given = {
        **{"file": sbet(tmp_path, roll_deg=2.0), "flash_rate_hz": 2.0, "height_m": 224.5},
        **{"legs_s": [[1.0, 3.0], [5.0, 5.5]], "offset_up_m": -5.0, "offset_northing_m": 100.0},
    }
    scenario = make(flight=given)
    frames = components.frames(scenario)
    assert [frame.line for frame in frames] == [0] * 5 + [1] * 2
    assert [frame.time for frame in frames] == [1.0, 1.5, 2.0, 2.5, 3.0, 5.0, 5.5]
    on_map = components.map_frame(scenario).to_map(frames[0].pose.position)
    assert on_map == pytest.approx([500060.0, 6000100.0, 225.0], abs=1e-5)
    assert np.degrees(frames[0].pose.roll) == pytest.approx(2.0)
    assert np.degrees(frames[0].pose.heading) == pytest.approx(90.0)
    assert components.flight_size(scenario) == "lines: 2, frames: 7"
    assert components.seabed(scenario).mesh.bounds is not None


def test_units_and_senses_of_motion_and_navigation(make: Any) -> None:
    scenario = make(
        motion={"pitch_mean_deg": 2.0, "roll": [{"rms_deg": 3.0, "period_s": 6.0}]},
        navigation={
            **{"gnss_bias_up_m": 0.2, "ins_white_heading_deg": 0.01, "boresight_pitch_deg": 10.0},
            **{"boresight_error_pitch_deg": 1.0, "lever_arm_error_right_m": 0.1},
        },
        receiver=WIDE_RECEIVER,
    )
    motion, navigation = build_motion(scenario.motion), build_navigation(scenario.navigation)
    assert motion.pitch_mean == pytest.approx(np.radians(2.0))
    assert motion.roll[0].rms == pytest.approx(np.radians(3.0))
    assert (motion.roll[0].period, motion.roll[0].damping) == (6.0, 0.3)
    assert (navigation.up.bias, navigation.east.bias) == (0.2, 0.0)
    assert navigation.heading.white == pytest.approx(np.radians(0.01))
    assert navigation.mounting.pitch == pytest.approx(np.radians(11.0))
    assert navigation.believed_mounting.pitch == pytest.approx(np.radians(10.0))
    assert navigation.mounting.lever_arm == (0.0, 0.1, 0.0)
    assert navigation.believed_mounting.lever_arm == (0.0, 0.0, 0.0)


def test_the_seed_moves_the_aircraft(make: Any) -> None:
    swings = {"roll": [{"rms_deg": 0.5, "period_s": 6.0}]}
    rolls = [
        components.frames(make(motion=swings).replace(**{"mission.seed": seed}))[1].pose.roll
        for seed in (1, 1, 2)
    ]
    assert rolls[0] == rolls[1] != rolls[2]


def test_the_gate_opens_for_the_lowest_height(make: Any, tables: dict[str, Any]) -> None:
    steps = [{"distance_m": 0.0, "height_m": 180.0}, {"distance_m": 90.0, "height_m": 210.0}]
    scenario = make(flight={**tables["flight"], "height_profile": steps})
    assert components.receiver(scenario).gate_start == pytest.approx(
        2.0 * 180.0 / 299_792_458.0 - 30e-9
    )
    plan = components.flight_plan(scenario)
    assert plan.swath == pytest.approx(2.0 * 0.128 * 180.0)  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("flight", "words"),
    [
        (
            {"corners_m": [CORNERS[0], CORNERS[2], CORNERS[1], CORNERS[3]], "heading_deg": 0.0},
            ["flight.corners_m: side 0-1 crosses side 2-3 near easting 500100.0, northing 6000300"],
        ),
        ({"corners_m": CORNERS[:2], "heading_deg": 0.0}, ["flight.corners_m: 2 corners. Give 3"]),
        (
            {"corners_m": [[1.0], [2.0, 3.0, 4.0]], "heading_deg": 400.0},
            ["flight.corners_m.0: ", "flight.corners_m.1: ", "flight.heading_deg: 400.0 is out"],
        ),
        (
            {"corners_m": CORNERS, "file": "a.geojson", "heading_deg": 0.0},
            ["flight.corners_m: give an area its corners_m or a file"],
        ),
        ({"kind": "area", "heading_deg": 0.0}, ["flight.corners_m: give an area its corners_m"]),
        ({"file": "a.geojson", "heading_deg": 0.0}, ["flight.file: no file 'a.geojson' in"]),
        ({"file": "track.out"}, ["flight.file: no file 'track.out' in"]),
        (
            {"corners_m": CORNERS, "heading_deg": 0.0, "lines": 3},
            ["flight.lines: unknown key. It goes with kind = lines."],
        ),
        ({"kind": "aera", "heading_deg": 0.0}, ["flight.kind: 'aera' is not one of lines, area,"]),
        (
            {"corners_m": CORNERS, "heading_deg": 0.0, "flash_rate_hz": 1e6, "speed_m_s": 0.1},
            ["flight.flash_rate_hz: ", "frames in all. Stay below 1000000."],
        ),
        (
            {"corners_m": CORNERS, "heading_deg": 0.0, "wind_speed_m_s": 50.0, "speed_m_s": 40.0},
            ["flight.wind_speed_m_s: 50 is not below the ground speed of 40."],
        ),
        (
            {
                **{"corners_m": CORNERS, "heading_deg": 0.0},
                "height_profile": [
                    {"distance_m": 9.0, "height_m": 200.0},
                    {"distance_m": 3.0, "height_m": 200.0},
                ],
            },
            ["flight.height_profile.1.distance_m: 3 is not beyond 9 before it."],
        ),
    ],
)
def test_faults_of_a_flight_are_told(make: Any, flight: dict[str, Any], words: list[str]) -> None:
    found = "\n".join(faults_of(make, flight=flight))
    for word in words:
        assert word in found


def test_faults_of_a_trajectory_are_told_with_those_of_other_sections(
    make: Any, tmp_path: Path
) -> None:
    name = sbet(tmp_path)
    (tmp_path / name).write_bytes((tmp_path / name).read_bytes()[:-9])
    found = faults_of(make, flight={"file": name}, water={"type": "coastel"})
    assert len(found) == 2
    assert found[0].startswith("water.type: 'coastel' is not one of") or found[1].startswith(
        "water"
    )
    assert any("track.sbet: 6927 bytes are no whole number of records" in line for line in found)


@pytest.mark.parametrize(
    ("flight", "words"),
    [
        ({"height_m": 190.0}, "the gate closes at 1538 ns, before the corner pixels"),
        ({"legs_s": [[3.0, 1.0]]}, "flight.legs_s.0: [3, 1] does not follow 0 s. Sort the legs."),
        ({"legs_s": [[1.0, 99.0]]}, "flight.legs_s.0: 99 s is beyond the file's last record at 10"),
        ({"offset_up_m": -400.0}, "comes down to -170 m above the water"),
        ({"format": "xyz"}, "flight.format: 'xyz' is not one of csv, cblue, sbet."),
    ],
)
def test_faults_of_a_recorded_flight_are_told(
    make: Any, flight: dict[str, Any], words: str, tmp_path: Path
) -> None:
    given = {"file": sbet(tmp_path), "height_m": 229.5, **flight}
    assert words in "\n".join(faults_of(make, flight=given))


def test_a_file_without_a_known_ending_needs_its_format(make: Any, tmp_path: Path) -> None:
    (tmp_path / sbet(tmp_path)).rename(tmp_path / "track.dat")
    (line,) = faults_of(make, flight={"file": "track.dat"})
    assert line.startswith("flight.format: the file's name ends in none of .csv, .txt")
    assert make(flight={"file": "track.dat", "format": "sbet", "height_m": 229.5})


def test_a_recorded_flight_takes_no_other_motion(make: Any, tmp_path: Path) -> None:
    flight = {"file": sbet(tmp_path), "height_m": 229.5}
    assert faults_of(make, flight=flight, motion={"roll_mean_deg": 1.0}) == [
        "motion: the trajectory's file has the motion. Leave this section out."
    ]
    assert make(flight=flight, motion={"source": "assumed"})


def test_a_gate_too_short_for_the_roll_is_told(make: Any) -> None:
    swings = [{"rms_deg": 6.0, "period_s": 6.0}]
    (line,) = faults_of(make, motion={"roll": swings})
    assert line.startswith("receiver.bins: the gate closes at 1604 ns, before the corner pixels")
    assert "(height 200 m, roll 24.0, pitch 0.0 degrees)" in line
    bins = int(line.split("at least ")[1].split()[0])
    assert make(motion={"roll": swings}, receiver={**RECEIVER, "bins": bins})
    assert faults_of(make, motion={"roll": swings}, receiver={**RECEIVER, "bins": bins - 2})
    (line,) = faults_of(make, motion={"roll": [{"rms_deg": 22.0, "period_s": 6.0}]})
    assert line.startswith("flight: corner pixels look above the horizon")


def test_frames_that_see_no_water_are_named(make: Any) -> None:
    scenario = make()
    frames = components.frames(scenario)
    tilted = [replace(frame, pose=replace(frame.pose, roll=1.5)) for frame in frames]
    with pytest.raises(ValueError, match=r"frame 0, 0\.0 s: 200 m above the water, roll 85\.9"):
        footprints(components.camera(scenario), tilted, 0.5)
    with pytest.raises(ValueError, match=r"and 15 other frames"):
        footprints(components.camera(scenario), tilted * 10, 0.5)


def test_ground_in_the_way_is_refused(make: Any) -> None:
    frames = components.frames(make())
    require_air(frames, highest=200.0)
    with pytest.raises(ValueError, match=r"frame 0 is at 200\.5 m, and the ground rises to 250\.0"):
        require_air(frames, highest=250.0)


def test_the_command_tells_all_faults_and_returns_2(tables: dict[str, Any], tmp_path: Path) -> None:
    crossed = [CORNERS[0], CORNERS[2], CORNERS[1], CORNERS[3]]
    tables["flight"] = {"corners_m": crossed, "heading_deg": 0.0}
    tables["motion"] = {"rol": []}
    tables["navigation"] = {"gnss_white_up_m": -1.0}
    file = tmp_path / "bad.toml"
    file.write_text(to_toml(tables), encoding="utf-8")
    result = CliRunner().invoke(app, ["check", str(file)])
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 3
    assert "motion.rol: unknown key. Did you mean 'roll'?" in result.stderr
    assert "Traceback" not in result.output


def test_areas_from_geojson_are_part_of_the_run(make: Any, tmp_path: Path) -> None:
    ring = [[9.0, 54.1], [9.004, 54.1], [9.004, 54.104], [9.0, 54.104], [9.0, 54.1]]
    area = {"type": "Polygon", "coordinates": [ring]}
    (tmp_path / "area.geojson").write_text(json.dumps(area), encoding="utf-8")
    scenario = make(flight={"file": "area.geojson", "heading_deg": 0.0})
    assert "area.geojson" in scenario.files
    assert components.flight_plan(scenario).line_count > 3
    holed = {**area, "coordinates": [ring, ring]}
    (tmp_path / "area.geojson").write_text(json.dumps(holed) + " ", encoding="utf-8")
    (line,) = faults_of(make, flight={"file": "area.geojson", "heading_deg": 0.0})
    assert line == ("flight.file: area.geojson: the polygon has 1 holes. Keep its outline alone.")


def test_areas_are_read_in_a_child_whatever_becomes_of_it(make: Any, tmp_path: Path) -> None:
    """A list nested 200,000 deep; and the parent never sees the file's text."""
    deep = 200_000
    (tmp_path / "deep.geojson").write_text("[" * deep + "]" * deep, encoding="utf-8")
    (line,) = faults_of(make, flight={"file": "deep.geojson", "heading_deg": 0.0})
    assert line.startswith("flight.file: deep.geojson: no GeoJSON: maximum recursion depth")


def test_foreign_files_are_opened_by_children_alone(
    make: Any, tables: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "area.geojson").write_text("{}", encoding="utf-8")
    (tmp_path / "phase.csv").write_text("angle_deg,value\n1,8\n", encoding="utf-8")
    asked = []

    def reading(reader: str, path: Path, **_: Any) -> Any:
        asked.append((reader, path.name))
        raise ForeignFileError(path, ["not touched"])

    monkeypatch.setattr("survey.flight.files.foreign.read_foreign", reading)
    monkeypatch.setattr("survey.optics.phase.table.read_foreign", reading)
    phase = {"kind": "table", "file": "phase.csv"}
    lines = faults_of(
        make,
        flight={"file": "area.geojson", "heading_deg": 0.0},
        water={"type": "coastal", "phase_function": phase},
    )
    assert [line.split(": ")[-1] for line in lines] == ["not touched."] * 2
    assert set(asked) == {
        ("survey.flight.files.foreign:area_corners", "area.geojson"),
        ("survey.optics.phase.table:table_columns", "phase.csv"),
    }
