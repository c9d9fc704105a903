"""All products of made frames: by few tiles or many, and what goes wrong."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import rasterio

from survey.cloud.points import Outcome, PointClass, PointCloud
from survey.optics.water import WaterColumn, petzold_water
from survey.products import stitching
from survey.products.frame_file import FrameResult
from survey.products.ply_file import read_ply
from survey.products.run_products import ProductSettings, write_products
from survey.products.writing import ProductError
from survey.sensor.camera import Camera


@dataclass
class Progress:
    """Remembers how many steps were told and done."""

    total: int = 0
    done: int = 0

    def writing(self, total: int) -> None:
        self.total = total

    def written(self, steps: int) -> None:
        self.done += steps


@pytest.fixture(scope="module")
def results(small_survey: Any) -> dict[int, FrameResult]:
    bottom, surface = small_survey.bottom, small_survey.surface
    return {
        number: FrameResult(
            bottom=bottom.select(bottom.frame == number),
            surface=surface.select(surface.frame == number),
            record=record,
        )
        for number, record in enumerate(small_survey.records)
    }


def settings(survey: Any) -> ProductSettings:
    water = petzold_water("coastal", refractive_index=1.34, group_index=1.36)
    return ProductSettings(
        title="Bar",
        description="Made.",
        start_utc=survey.start_utc,
        water_level=survey.water_level,
        thinning=7.0,
        grid=4.0,
        pixel_spacing=6.4,
        survey_area=None,
        trajectory_files=(),
        deviations=(0.0,) * 6,
        water=WaterColumn.uniform(water),
        camera=Camera(rows=8, columns=16, pixel_tangent=0.032, long_side="along"),
        order=None,
        cubes=(),
    )


def write(folder: Path, survey: Any, results: dict[int, FrameResult], **more: Any) -> Path:
    folder.mkdir()
    seabed: Any = SimpleNamespace(
        map_frame=survey.map_frame,
        elevation_at=survey.elevation_at,
        substrate_names={1: "sand"},
        grid=SimpleNamespace(z_low=-20.0, z_high=5.0),
    )
    write_products(
        folder,
        read=results.__getitem__,
        frames=[frame for frame in survey.frames if frame.index in results],
        seabed=seabed,
        settings=settings(survey),
        **more,
    )
    return folder


def bands(folder: Path) -> Any:
    with rasterio.open(folder / "bathymetry.tif") as file:
        return file.read()


def test_tiles_change_the_order_of_points_and_nothing_else(
    small_survey: Any,
    results: dict[int, FrameResult],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    progress: Any = Progress()
    one = write(tmp_path / "one", small_survey, results, watch=progress)
    assert progress.done == progress.total == 2 * len(results)
    monkeypatch.setattr(stitching, "POINTS_OF_A_TILE", 1000)
    progress = Progress()
    many = write(tmp_path / "many", small_survey, results, watch=progress)
    assert progress.done == progress.total > 3 * len(results)

    same = ("metrics.json", "coverage.geojson", "bathymetry.glb", "trajectory.csv", "report.html")
    for name in same:
        assert (one / name).read_bytes() == (many / name).read_bytes(), name
    assert np.array_equal(bands(one), bands(many), equal_nan=True)
    for name in ("bottom", "water_surface"):
        clouds = [read_ply(folder / f"{name}.ply")[0] for folder in (one, many)]
        assert not np.array_equal(clouds[0].frame, clouds[1].frame)
        assert np.array_equal(*(in_flight_order(cloud).position for cloud in clouds))


def in_flight_order(cloud: PointCloud) -> PointCloud:
    return cloud.select(np.lexsort((cloud.column, cloud.row, cloud.frame)))


def test_the_grid_is_whole_also_where_no_frame_is(
    small_survey: Any, results: dict[int, FrameResult], tmp_path: Path
) -> None:
    """Frames at both ends of the first line and of the last: blocks between them hold nothing."""
    far = replace(small_survey, frames=[small_survey.frames[0], small_survey.frames[31]])
    apart = {0: results[0], 31: moved(results[31], 3000.0)}
    elevation, density, *_ = bands(write(tmp_path / "run", far, apart))
    assert np.isfinite(density).all()
    assert np.array_equal(density > 0.0, np.isfinite(elevation))
    assert (density == 0.0).mean() > 0.99


def moved(result: FrameResult, distance: float) -> FrameResult:
    shift = np.array([distance, 0.0, 0.0])
    clouds = {
        name: replace(getattr(result, name), position=getattr(result, name).position + shift)
        for name in ("bottom", "surface")
    }
    record = replace(result.record, true_position=result.record.true_position + shift)
    return replace(result, **clouds, record=record)


def test_no_bottom_is_an_error_before_anything_is_written(
    small_survey: Any, results: dict[int, FrameResult], tmp_path: Path
) -> None:
    lost = {
        number: replace(
            result,
            bottom=replace(
                result.bottom,
                classification=np.full(len(result.bottom), PointClass.NO_BOTTOM_FOUND, np.uint8),
            ),
            record=replace(
                result.record, outcome=np.full_like(result.record.outcome, Outcome.TOO_DEEP)
            ),
        )
        for number, result in results.items()
    }
    with pytest.raises(ProductError, match="no bottom found: the bottom echo is too weak"):
        write(tmp_path / "run", small_survey, lost)
    assert list((tmp_path / "run").iterdir()) == []


def test_a_frame_that_cannot_be_read_leaves_no_half_of_a_product(
    small_survey: Any, results: dict[int, FrameResult], tmp_path: Path
) -> None:
    class Torn(dict[int, FrameResult]):
        reads = 0

        def __getitem__(self, number: int) -> FrameResult:
            Torn.reads += 1
            if Torn.reads > len(self) + 5:
                raise ValueError("000007.npz: not a whole frame")
            return super().__getitem__(number)

    with pytest.raises(ValueError, match="not a whole frame"):
        write(tmp_path / "run", small_survey, Torn(results))
    assert list((tmp_path / "run").iterdir()) == []


def test_metrics_are_those_of_the_stitched_clouds(
    small_survey: Any, results: dict[int, FrameResult], tmp_path: Path
) -> None:
    run = write(tmp_path / "run", small_survey, results)
    found = json.loads((run / "metrics.json").read_text())
    bottom, _ = read_ply(run / "bottom.ply")
    solid = bottom.classification == PointClass.BATHYMETRIC
    errors = (bottom.position[:, 2] - bottom.true_elevation)[solid]
    assert found["points_bottom"] == solid.sum()
    assert found["bias_m"] == pytest.approx(errors.mean(), abs=1e-6)
    assert found["p95_abs_error_m"] == pytest.approx(np.quantile(np.abs(errors), 0.95), abs=1.1e-6)
    assert found["frames"] == 32
    assert list(found["substrates"]) == ["unlabelled", "sand"]
