"""Made seabeds lie under the flight, where the scenario says."""

from __future__ import annotations

from math import radians, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.errors import UserError
from survey.flight.trajectory import fly_lines, footprint
from survey.scenario import Scenario, components
from terrain.file_faults import SeabedFileError

MADE: dict[str, dict[str, Any]] = {
    "plane": {"depth_m": 8.0},
    "slope": {"depth_m": 2.0, "slope_deg": 1.0, "downhill_deg": 120.0},
    "sandbar": {
        "shoreline_m": 30.0,
        "offshore_deg": 90.0,
        "slope_deg": 1.0,
        "bar_distance_m": 60.0,
        "bar_height_m": 0.5,
        "bar_sigma_m": 10.0,
    },
    "channel": {
        "depth_m": 4.0,
        "channel_depth_m": 9.0,
        "channel_easting_m": 500300.0,
        "channel_northing_m": 6000700.0,
        "channel_heading_deg": 20.0,
        "floor_width_m": 30.0,
        "side_slope_deg": 10.0,
    },
    "rough": {"depth_m": 5.0},
    "ripples": {"depth_m": 6.0, "wavelength_m": 8.0, "height_m": 0.6, "crest_deg": 20.0},
    "reef": {
        "depth_m": 9.0,
        "reef_depth_m": 3.0,
        "reef_easting_m": 500300.0,
        "reef_northing_m": 6000700.0,
        "reef_heading_deg": 20.0,
        "top_width_m": 30.0,
    },
}


def scenario_over(tables: dict[str, Any], kind: str, **more: Any) -> Scenario:
    tables["seabed"] = {"kind": kind, **MADE[kind], **more}
    return Scenario.from_tables(tables, name="reef.toml", folder=Path())


@pytest.mark.parametrize("kind", MADE)
@pytest.mark.parametrize("heading_deg", [0.0, 70.0, 200.0])
def test_every_made_seabed_reaches_its_margin_beyond_the_flight(
    tables: dict[str, Any], kind: str, heading_deg: float
) -> None:
    tables["flight"] |= {"heading_deg": heading_deg, "lines": 2}
    scenario = scenario_over(tables, kind, margin_m=40.0)
    seabed, camera = components.seabed(scenario), components.camera(scenario)
    for flash in fly_lines(components.flight_plan(scenario)):
        outline = footprint(camera, flash.pose, 0.5)
        for corner in outline + 39.0 / np.sqrt(2.0) * np.sign(outline - outline.mean(axis=0)):
            assert np.isfinite(seabed.elevation_at(corner[0], corner[1]))


def test_a_slope_has_its_depth_at_the_start_and_falls_downhill(tables: dict[str, Any]) -> None:
    seabed = components.seabed(scenario_over(tables, "slope"))
    assert float(seabed.elevation_at(250.0, 750.0)) == pytest.approx(-2.0)
    downhill = 50.0 * np.array([np.sin(radians(120.0)), np.cos(radians(120.0))])
    lower = float(seabed.elevation_at(250.0 + downhill[0], 750.0 + downhill[1]))
    assert lower == pytest.approx(-2.0 - 50.0 * tan(radians(1.0)))


def test_a_sandbar_s_shoreline_counts_from_the_start(tables: dict[str, Any]) -> None:
    seabed = components.seabed(scenario_over(tables, "sandbar", spacing_m=0.5))
    assert float(seabed.elevation_at(280.0, 750.0)) == pytest.approx(0.0, abs=0.02)
    crest = -60.0 * tan(radians(1.0)) + 0.5
    assert float(seabed.elevation_at(340.0, 750.0)) == pytest.approx(crest, abs=0.02)
    assert float(seabed.elevation_at(260.0, 750.0)) > 1.0


def test_a_channel_goes_through_its_point_along_its_heading(tables: dict[str, Any]) -> None:
    seabed = components.seabed(scenario_over(tables, "channel"))
    along = 40.0 * np.array([np.sin(radians(20.0)), np.cos(radians(20.0))])
    across = 60.0 * np.array([np.cos(radians(20.0)), -np.sin(radians(20.0))])
    point = np.array([300.0, 700.0])
    assert float(seabed.elevation_at(*(point + along))) == pytest.approx(-9.0)
    assert float(seabed.elevation_at(*(point + across))) == pytest.approx(-4.0)


def test_a_tide_does_not_move_the_bed(tables: dict[str, Any]) -> None:
    scenario = scenario_over(tables, "plane").replace(**{"surface.water_level_m": 3.0})
    assert float(components.seabed(scenario).elevation_at(250.0, 750.0)) == pytest.approx(-8.0)


def test_objects_stand_on_the_bed_where_the_map_says(tables: dict[str, Any]) -> None:
    cube = {"kind": "cube", "easting_m": 500260.0, "northing_m": 6000740.0, "side_m": 2.0}
    rock = {"kind": "boulder", "easting_m": 500300.0, "northing_m": 6000750.0, "reflectance": 0.3}
    seabed = components.seabed(scenario_over(tables, "plane", objects=[cube, rock]))
    assert float(seabed.elevation_at(260.0, 740.0)) == pytest.approx(-6.0)
    assert float(seabed.elevation_at(261.5, 740.0)) == pytest.approx(-8.0)
    assert -6.5 < float(seabed.elevation_at(300.0, 750.0)) < -3.5
    assert set(seabed.reflectance[seabed.is_object]) == {0.1, 0.3}


def test_an_object_beside_the_bed_is_the_user_s_fault(tables: dict[str, Any]) -> None:
    cube = {"kind": "cube", "easting_m": 0.0, "northing_m": 0.0}
    with pytest.raises(UserError, match=r"^reef\.toml: object: no seabed"):
        components.seabed(scenario_over(tables, "plane", objects=[cube]))


def written_raster(folder: Path) -> Path:
    """Write elevations that rise to the east by 1 in 100, and return the file."""
    import rasterio
    from affine import Affine

    file = folder / "bed.tif"
    elevation = np.tile(0.01 * (np.arange(200) * 5.0 + 2.5), (120, 1)) - 12.0
    with rasterio.open(
        file,
        "w",
        driver="GTiff",
        width=200,
        height=120,
        count=1,
        dtype="float64",
        crs="EPSG:25832",
        nodata=-9999.0,
        transform=Affine(5.0, 0.0, 500000.0, 0.0, -5.0, 6001000.0),
    ) as raster:
        raster.write(elevation, 1)
    return file


def test_a_raster_lies_in_the_mission_s_frame(tables: dict[str, Any], tmp_path: Path) -> None:
    written_raster(tmp_path)
    tables["seabed"] = {"kind": "raster", "file": "bed.tif", "margin_m": 50.0}
    scenario = Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)
    seabed, frame = components.seabed(scenario), components.map_frame(scenario)
    assert seabed.map_frame == frame
    assert float(seabed.elevation_at(250.0, 750.0)) == pytest.approx(-9.5)
    assert seabed.mesh.bounds[0, 0] > 100.0
    seabed.require_coverage([np.array([[210.0, 710.0], [390.0, 710.0], [390.0, 790.0]])])


def test_a_raster_of_another_map_is_the_user_s_fault(
    tables: dict[str, Any], tmp_path: Path
) -> None:
    written_raster(tmp_path)
    tables["seabed"] = {"kind": "raster", "file": "bed.tif"}
    tables["mission"]["crs_epsg"] = 25833
    scenario = Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)
    with pytest.raises(SeabedFileError, match=r"bed\.tif: crs: .*25833"):
        components.seabed(scenario)


def test_mesh_files_are_seabed_and_object(tables: dict[str, Any], tmp_path: Path) -> None:
    import trimesh

    trimesh.creation.box(extents=[1000.0, 1000.0, 2.0]).export(tmp_path / "slab.stl")
    trimesh.creation.box(extents=[4.0, 4.0, 3.0]).export(tmp_path / "hut.ply")
    hut = {"kind": "mesh", "file": "hut.ply", "easting_m": 500260.0, "northing_m": 6000740.0}
    tables["seabed"] = {
        "kind": "mesh",
        "file": "slab.stl",
        "offset_easting_m": 500250.0,
        "offset_northing_m": 6000750.0,
        "offset_up_m": -8.0,
        "objects": [hut],
    }
    scenario = Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)
    seabed = components.seabed(scenario)
    assert float(seabed.elevation_at(250.0, 750.0)) == pytest.approx(-7.0)
    assert float(seabed.elevation_at(260.5, 740.5)) == pytest.approx(-4.0)
