"""What the bottom is made of: the table, maps on meshes, labels that follow the faces."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
import trimesh
from affine import Affine

from terrain.cover import Cover, reflectance_cover, substrate_cover
from terrain.cover_faces import covered
from terrain.file_faults import SeabedFileError
from terrain.generators import Ground, plane, slope
from terrain.map_frame import MapFrame
from terrain.raycast import cast_rays
from terrain.seabed import Seabed
from terrain.substrate import FIRST_OWN_CODE, UNLABELLED, Substrate, known_substrates

FRAME = MapFrame(easting=500000.0, northing=6000000.0, epsg=25832, vertical_epsg=5714)
DOWN = np.array([0.0, 0.0, -1.0])
SAND, SEAGRASS = known_substrates()["sand"], known_substrates()["seagrass"]


def written(path: Path, values: np.ndarray, **changes: Any) -> Path:
    """Write a map of cells of 2 m about the middle of the frame, and return its file."""
    profile: dict[str, Any] = {
        "driver": "GTiff",
        "height": values.shape[0],
        "width": values.shape[1],
        "count": 1,
        "dtype": str(values.dtype),
        "crs": "EPSG:25832",
        "nodata": 0,
        "transform": Affine(
            2.0, 0.0, 500000.0 - values.shape[1], 0.0, -2.0, 6000000.0 + values.shape[0]
        ),
    }
    with rasterio.open(path, "w", **(profile | changes)) as sink:
        sink.write(values, 1)
    return path


def bed(spacing: float | None = None) -> Seabed:
    ground = Ground(map_frame=FRAME, length=120.0, width=120.0, reflectance=0.1)
    return slope(ground=ground, depth=6.0, gradient=0.05, spacing=spacing)


def seen_at(seabed: Seabed, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return code and reflectance of the faces under places, as the light finds them."""
    _, face = cast_rays(seabed.grid, np.column_stack([x, y, 0.0 * x]), DOWN)
    return seabed.substrate[face], seabed.reflectance[face]


def meadow() -> np.ndarray:
    """Return sand (1) with a disc of seagrass (2) about the middle and nothing (0) in the west."""
    row, col = np.mgrid[:40, :40]
    cells = np.where(np.hypot(row - 19.5, col - 19.5) < 10.0, 2, 1)
    cells[:, :5] = 0
    return cells.astype(np.uint8)


def meadow_cover(tmp_path: Path, **more: Any) -> Cover:
    path = written(tmp_path / "cover.tif", meadow())
    return substrate_cover(path, classes={1: SAND, 2: SEAGRASS}, epsg=25832, **more)


def test_the_table_has_every_code_once_and_below_one_s_own() -> None:
    known = known_substrates()
    codes = [substrate.code for substrate in known.values()]
    assert len(set(codes)) == len(codes)
    assert UNLABELLED < min(codes) <= max(codes) < FIRST_OWN_CODE
    assert all(0.0 < substrate.reflectance < 0.5 for substrate in known.values())


def test_the_table_is_that_of_its_source() -> None:
    """Maritorena et al. (1994) in steps of 5 nm, between 530 and 535 nm; others at 532 nm."""
    sources = {
        "coral_sand": np.interp(532.0, [530.0, 535.0], [0.429, 0.436]),
        "green_algae": np.interp(532.0, [530.0, 535.0], [0.246, 0.257]),
        "brown_algae": np.interp(532.0, [530.0, 535.0], [0.044, 0.046]),
        "red_algae": np.interp(532.0, [530.0, 535.0], [0.075, 0.074]),
        "sand": 0.242772507,
        "coral": 0.088382757,
        "coralline_crust": 0.152258969,
        "macroalgae": 0.043786044,
        "seagrass": 0.01518,
    }
    for name, reflectance in sources.items():
        assert known_substrates()[name].reflectance == pytest.approx(reflectance, abs=5.1e-4)


@pytest.mark.parametrize("spacing", [None, 1.0, 7.0])
def test_light_finds_what_the_map_shows(tmp_path: Path, spacing: float | None) -> None:
    """On two triangles as on many: the map, not the mesh, says where a meadow ends."""
    seabed = covered(bed(spacing), meadow_cover(tmp_path))
    row, col = np.mgrid[:40, :40]
    x, y = (2.0 * (col - 19.5)).ravel() + 0.01, (2.0 * (19.5 - row)).ravel() + 0.02
    code, reflectance = seen_at(seabed, x, y)
    shown = meadow().ravel()
    agree = code == np.array([UNLABELLED, SAND.code, SEAGRASS.code])[shown]
    assert agree.mean() > 0.96
    off = np.hypot(x, y)[~agree & (x > -28.0)]
    assert np.abs(off - 20.0).max(initial=0.0) < 3.0  # along the rim, within a cell of it
    np.testing.assert_array_equal(reflectance[agree], np.array([0.1, 0.243, 0.015])[shown[agree]])
    assert seabed.substrate_names == {SAND.code: "sand", SEAGRASS.code: "seagrass"}


def test_splitting_keeps_the_shape_and_splits_where_the_map_changes(tmp_path: Path) -> None:
    before = bed()
    after = covered(before, meadow_cover(tmp_path))
    assert after.mesh.area == pytest.approx(before.mesh.area)
    x, y = np.random.default_rng(1).uniform(-59.0, 59.0, (2, 20_000))
    np.testing.assert_allclose(after.elevation_at(x, y), before.elevation_at(x, y), atol=1e-9)
    mixed = trimesh.triangles.extents(after.mesh.triangles)[:, :2].max(axis=1)
    centre = after.mesh.triangles_center
    far_inside = np.hypot(centre[:, 0], centre[:, 1]) < 8.0
    assert mixed[far_inside].max() > 7.0
    assert len(after.mesh.faces) < 12_000
    whole = covered(
        before,
        substrate_cover(
            written(tmp_path / "one.tif", np.ones((90, 90), np.uint8)),
            classes={1: SAND},
            epsg=25832,
        ),
    )
    assert len(whole.mesh.faces) == 2


def test_a_map_beyond_its_rim_and_without_data_leaves_the_bottom_as_it_was(tmp_path: Path) -> None:
    rock = Substrate(code=FIRST_OWN_CODE, name="my rock", reflectance=0.2)
    seabed = covered(bed().painted(slice(None), rock), meadow_cover(tmp_path))
    code, reflectance = seen_at(seabed, np.array([-35.0, 55.0, 30.0]), np.array([1.0, 2.0, 3.0]))
    assert code.tolist() == [FIRST_OWN_CODE, FIRST_OWN_CODE, SAND.code]
    assert reflectance.tolist() == [0.2, 0.2, 0.243]
    assert seabed.substrate_names[FIRST_OWN_CODE] == "my rock"


def test_only_the_cells_about_an_outline_count(tmp_path: Path) -> None:
    corner = np.array([[500030.0, 6000030.0], [500034.0, 6000034.0]])
    near = meadow_cover(tmp_path, outline=corner, margin=2.0)
    assert near.kind.shape[0] < 9
    seabed = covered(bed(), near)
    assert seen_at(seabed, np.array([31.0]), np.array([31.0]))[0] == SAND.code
    assert seen_at(seabed, np.array([0.5]), np.array([0.5]))[0] == UNLABELLED


def test_a_raster_of_reflectances_leaves_the_labels(tmp_path: Path) -> None:
    cells = np.full((30, 30), 0.3, np.float32)
    cells[:, 15:] = 0.05
    path = written(tmp_path / "bright.tif", cells, nodata=-1.0)
    seabed = covered(bed().painted(slice(None), SAND), reflectance_cover(path, epsg=25832))
    code, reflectance = seen_at(seabed, np.array([-9.0, 9.0, 45.0]), np.array([3.0, 3.0, 3.0]))
    np.testing.assert_allclose(reflectance, [0.3, 0.05, 0.243], atol=1e-7)
    assert set(code.tolist()) == {SAND.code}


def test_maps_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path / "cover.tif", meadow())
    with pytest.raises(SeabedFileError, match=r"cover\.tif: class 2: no substrate is given"):
        substrate_cover(path, classes={1: SAND}, epsg=25832)
    bright = written(tmp_path / "b.tif", np.full((9, 9), 24.3, np.float32), nodata=-1.0)
    with pytest.raises(SeabedFileError, match=r"row 0, column 0: reflectance 24\.3 is not within"):
        reflectance_cover(bright, epsg=25832)
    empty = written(tmp_path / "e.tif", np.zeros((9, 9), np.uint8))
    with pytest.raises(SeabedFileError, match="no cell has data where it is flown"):
        substrate_cover(empty, classes={1: SAND}, epsg=25832)
    with pytest.raises(SeabedFileError) as refused:
        reflectance_cover(written(tmp_path / "n.tif", meadow(), crs=None, nodata=None), epsg=25832)
    assert [line.split(": ")[1] for line in str(refused.value).splitlines()] == ["crs", "nodata"]
    told = written(tmp_path / "t.tif", np.full((9, 9), 0.5, np.float32), nodata=None)
    assert reflectance_cover(told, epsg=25832, nodata="none").kind.min() == 0
    with pytest.raises(SeabedFileError, match="no cell has data"):
        reflectance_cover(told, epsg=25832, nodata=0.5)


def test_labels_follow_objects() -> None:
    ground = Ground(map_frame=FRAME, length=40.0, width=40.0, reflectance=0.1)
    flat = plane(ground=ground, depth=5.0).painted(slice(None), SAND)
    box = trimesh.creation.box(extents=[2.0, 2.0, 2.0])
    box.apply_translation([0.0, 0.0, -4.0])
    steel = known_substrates()["steel"]
    both = flat.with_object(box, reflectance=0.08, source="A box.")
    assert set(both.substrate[both.is_object]) == {UNLABELLED}
    both = both.painted(both.is_object, steel)
    code, reflectance = seen_at(both, np.array([0.1, 9.0]), np.array([0.2, 0.1]))
    assert code.tolist() == [steel.code, SAND.code]
    assert reflectance.tolist() == [0.08, 0.243]
