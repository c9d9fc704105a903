"""What a scenario says a seabed is made of, and its faults."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from affine import Affine
from typer.testing import CliRunner

from survey.cli import app
from survey.scenario import Scenario, ScenarioError, components
from survey.scenario.load import load_scenario
from terrain.raycast import cast_rays
from terrain.seabed import Seabed
from terrain.substrate import FIRST_OWN_CODE, known_substrates


def scenario_with(tables: dict[str, Any], folder: Path = Path(), **seabed: Any) -> Scenario:
    tables["seabed"] = {"kind": "plane", "depth_m": 8.0, **seabed}
    return Scenario.from_tables(tables, name="reef.toml", folder=folder)


def lines_of(tables: dict[str, Any], **seabed: Any) -> tuple[str, ...]:
    with pytest.raises(ScenarioError) as caught:
        scenario_with(tables, **seabed)
    return caught.value.lines


def at(seabed: Seabed, east: float, north: float) -> tuple[str | None, float]:
    """Return name and reflectance of what lies at a place of the local frame."""
    down = np.array([0.0, 0.0, -1.0])
    _, face = cast_rays(seabed.grid, np.array([[east, north, 100.0]]), down)
    return seabed.substrate_names.get(int(seabed.substrate[face[0]])), seabed.reflectance[face[0]]


def written_cover(folder: Path) -> None:
    """Write sand (1) to the west and weed (5) to the east of easting 500300."""
    cells = np.ones((60, 80), np.uint8)
    cells[:, 40:] = 5
    with rasterio.open(
        folder / "cover.tif",
        "w",
        driver="GTiff",
        width=80,
        height=60,
        count=1,
        dtype="uint8",
        crs="EPSG:25832",
        nodata=0,
        transform=Affine(5.0, 0.0, 500100.0, 0.0, -5.0, 6000900.0),
    ) as raster:
        raster.write(cells, 1)


CLASSES = [
    {"value": 1, "substrate": "sand"},
    {"value": 5, "substrate": "kelp", "reflectance": 0.03},
]


def test_a_seabed_s_reflectance_is_that_of_its_substrate_unless_stated(
    tables: dict[str, Any],
) -> None:
    for given, expected in (
        ({}, (None, 0.1)),
        ({"reflectance": 0.3}, (None, 0.3)),
        ({"substrate": "coral_sand"}, ("coral_sand", 0.432)),
        ({"substrate": "sand", "reflectance": 0.2}, ("sand", 0.2)),
        ({"substrate": "tiles", "reflectance": 0.5}, ("tiles", 0.5)),
    ):
        scenario = scenario_with(tables, **given)
        assert at(components.seabed(scenario), 250.0, 750.0) == expected


def test_objects_are_made_of_what_they_say_and_codes_are_kept(tables: dict[str, Any]) -> None:
    place = {"easting_m": 500260.0, "northing_m": 6000740.0}
    objects = [
        {"kind": "cube", "substrate": "concrete", **place},
        {"kind": "boulder", "substrate": "gneiss", "reflectance": 0.3, "easting_m": 500300.0,
         "northing_m": 6000750.0},
        {"kind": "boulders", "substrate": "rock", "easting_m": 500330.0, "northing_m": 6000760.0,
         "length_m": 10.0, "width_m": 10.0, "density_per_m2": 0.2},
        {"kind": "pipeline", "substrate": "steel",
         "route_m": [[500250.0, 6000720.0], [500320.0, 6000720.0]]},
    ]  # fmt: skip
    seabed = components.seabed(scenario_with(tables, substrate="sand", objects=objects))
    assert at(seabed, 260.0, 740.0) == ("concrete", 0.2)
    assert at(seabed, 300.0, 750.0) == ("gneiss", 0.3)
    assert at(seabed, 280.0, 720.0) == ("steel", 0.08)
    assert at(seabed, 250.0, 750.0) == ("sand", 0.243)
    names = {code: name for code, name in seabed.substrate_names.items() if name != "gneiss"}
    assert names == {known_substrates()[name].code: name for name in names.values()}
    assert seabed.substrate_names[FIRST_OWN_CODE] == "gneiss"
    rocks = seabed.substrate == known_substrates()["rock"].code
    assert seabed.is_object[rocks].all()
    assert len(np.unique(seabed.mesh.faces[rocks])) > 162 * 5


def test_a_map_lies_under_the_flight(tables: dict[str, Any], tmp_path: Path) -> None:
    written_cover(tmp_path)
    chart = {"file": "cover.tif", "classes": CLASSES}
    scenario = scenario_with(tables, tmp_path, map=chart, substrate="mud")
    seabed = components.seabed(scenario)
    assert at(seabed, 297.0, 740.0) == ("sand", 0.243)
    assert at(seabed, 303.0, 740.0) == ("kelp", 0.03)
    assert scenario.files == ["cover.tif"]
    resolved = tmp_path / "resolved.toml"
    resolved.write_text(scenario.to_toml(), encoding="utf-8")
    again = components.seabed(load_scenario(resolved))
    np.testing.assert_array_equal(again.reflectance, seabed.reflectance)
    assert again.substrate_names == seabed.substrate_names


def test_resolved_scenarios_state_every_reflectance(tables: dict[str, Any]) -> None:
    cube = {"kind": "cube", "easting_m": 500260.0, "northing_m": 6000740.0, "substrate": "steel"}
    text = scenario_with(tables, substrate="sand", objects=[cube]).to_toml()
    assert text.count("reflectance = 0.243") == text.count("reflectance = 0.08") == 1


def test_faults_of_substrates_are_told(tables: dict[str, Any]) -> None:
    place = {"easting_m": 1.0, "northing_m": 2.0}
    chart = {"file": "no.tif", "classes": [{"value": 1}, {"value": 1, "substrate": "seegrass"}]}
    found = lines_of(
        tables,
        substrate="snad",
        map=chart,
        objects=[
            {"kind": "boulders", "length_m": 9.0, "width_m": 9.0, "mean_diameter_m": 9.0, **place}
        ],
    )
    heads = [line.split(": ")[1] for line in found]
    assert heads == [
        "seabed.objects.0.mean_diameter_m",
        "seabed.substrate",
        "seabed.map.classes.0.substrate",
        "seabed.map.classes.1.substrate",
        "seabed.map.classes.1.value",
        "seabed.map.file",
    ]
    assert "Did you mean 'sand'?" in found[1]
    assert "Did you mean 'seagrass'?" in found[3]


def test_the_table_s_reflectances_are_those_of_green_light(tables: dict[str, Any]) -> None:
    tables["laser"] = {"wavelength_nm": 555.0}
    assert lines_of(tables, substrate="sand") == (
        "reef.toml: seabed.substrate: the reflectance of sand is known at 532 nm, not at 555. "
        "State the reflectance.",
    )
    scenario_with(tables, substrate="sand", reflectance=0.2)


@pytest.mark.parametrize(
    ("seabed", "line"),
    [
        (
            {"kind": "ripples", "depth_m": 5.0, "wavelength_m": 1.0, "height_m": 0.1,
             "crest_deg": 0.0},
            "seabed.spacing_m: 0.5 does not show ripples of 1 m. Take 0.125 at most.",
        ),
        (
            {"kind": "reef", "depth_m": 5.0, "reef_depth_m": 6.0, "reef_easting_m": 1.0,
             "reef_northing_m": 1.0, "reef_heading_deg": 0.0, "top_width_m": 9.0},
            "seabed.reef_depth_m: 6 is not shallower than depth_m 5. Raise the reef.",
        ),
        (
            {"nodata": 3.0},
            "seabed.nodata: unknown key. It goes with kind = raster.",
        ),
        (
            {"kind": "raster", "file": "a.tif", "nodata": "nothing"},
            "seabed.nodata: 'nothing': neither a number nor \"none\".",
        ),
    ],
)  # fmt: skip
def test_forms_that_cannot_be_are_refused(
    tables: dict[str, Any], seabed: dict[str, Any], line: str
) -> None:
    tables["seabed"] = {"kind": "plane", "depth_m": 5.0} if "kind" not in seabed else {}
    tables["seabed"] |= seabed
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_tables(tables, name="reef.toml", folder=Path())
    assert caught.value.lines == (f"reef.toml: {line}",)


def test_check_reads_every_file_of_a_seabed_and_tells_all_faults(
    tables: dict[str, Any], tmp_path: Path
) -> None:
    with rasterio.open(
        tmp_path / "bed.tif",
        "w",
        driver="GTiff",
        width=200,
        height=200,
        count=1,
        dtype="float32",
        transform=Affine(5.0, 0.0, 499800.0, 0.0, -5.0, 6001300.0),
    ) as raster:
        raster.write(np.full((200, 200), -8.0, np.float32), 1)
    written_cover(tmp_path)
    (tmp_path / "hut.obj").write_text("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", encoding="utf-8")
    (tmp_path / "hut.ply").write_text("no mesh", encoding="utf-8")
    hut = {"kind": "mesh", "easting_m": 500260.0, "northing_m": 6000740.0}
    tables["seabed"] = {
        "kind": "raster",
        "file": "bed.tif",
        "map": {"file": "cover.tif", "classes": CLASSES[:1]},
        "objects": [{**hut, "file": "hut.obj"}, {**hut, "file": "hut.ply"}],
    }
    scenario = Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)
    file = tmp_path / "reef.toml"
    file.write_text(scenario.to_toml(), encoding="utf-8")
    result = CliRunner().invoke(app, ["check", str(file)])
    assert result.exit_code == 2
    words = [line.removeprefix(f"{tmp_path}/") for line in result.output.splitlines()]
    assert [line.partition(". ")[0] for line in words] == [
        "bed.tif: crs: none in the file",
        "bed.tif: nodata: the file does not say which cells have no data",
        "cover.tif: class 5: no substrate is given",
        "hut.obj: vertex 1: a coordinate is not a finite number",
        "hut.ply: not a readable mesh file: fetch or export it again",
    ]
