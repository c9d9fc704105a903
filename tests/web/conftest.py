"""A small run made by hand, its page, and a browser to open it in."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey.cloud.points import Cause, PointClass, PointCloud
from terrain.map_frame import MapFrame
from viewer.run_folder import FlownSurvey
from viewer.web.columns import logarithmic, packed
from viewer.web.page import html, page_contents
from viewer.web.points import chosen_points

ROWS, COLUMNS, FRAMES = 12, 24, 6
LEVEL = 0.25
BROWSERS = ("chromium", "chromium-browser")
FLAGS = (
    *("--headless=new", "--no-sandbox", "--disable-background-networking"),
    *("--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
)
MISSING = (
    "NO CHROMIUM: the web page is NOT tested in a browser. On Debian type: "
    "apt-get install -y chromium"
)


def made_cloud(*, frames: int = FRAMES, rows: int = ROWS, columns: int = COLUMNS) -> PointCloud:
    """Return points over a slope from land to 9 m depth, every 20th without a bottom."""
    frame, row, column = (i.ravel() for i in np.mgrid[0:frames, 0:rows, 0:columns])
    lot = np.random.default_rng(1)
    n = frame.size
    x = 1.6 * (columns * frame + column) + lot.normal(0.0, 0.05, n)
    y = 1.6 * row + lot.normal(0.0, 0.05, n)
    true = 1.0 - 10.0 * x / (1.6 * columns * frames) + 0.3 * np.sin(y / 6.0)
    error, scatter = lot.normal(0.01, 0.05, n), lot.lognormal(0.0, 0.2, n)
    classes = np.where(true > LEVEL, PointClass.GROUND, PointClass.BATHYMETRIC)
    classes[::20] = PointClass.NO_BOTTOM_FOUND
    z = np.where(classes == PointClass.NO_BOTTOM_FOUND, LEVEL, true + error)
    place = np.column_stack([x, y, z])
    echo = classes != PointClass.NO_BOTTOM_FOUND
    return PointCloud(
        position=place,
        uncorrected=place,
        truth=np.column_stack([x, y, true]),
        classification=classes.astype(np.uint8),
        true_classification=classes.astype(np.uint8),
        substrate=(column % 2).astype(np.uint8),
        true_elevation=true,
        true_surface=np.column_stack([x, y, np.full(n, LEVEL)]),
        true_normal=np.tile(np.float32([0.0, 0.0, 1.0]), (n, 1)),
        water_path=np.maximum(LEVEL - true, 0.0).astype(np.float32),
        tvu=np.where(echo, (0.1 + 0.01 * np.abs(true)) * scatter, np.nan).astype(np.float32),
        thu=np.where(echo, 1.0, np.nan).astype(np.float32),
        cause=np.where(echo, Cause.RANGE_NOISE, Cause.NONE).astype(np.uint8),
        surface_elevation=np.full(n, LEVEL),
        reflectance=np.full(n, 0.2, np.float32),
        true_reflectance=np.full(n, 0.2, np.float32),
        time=frame.astype(np.float64),
        depth=LEVEL - z,
        counts=np.where(echo, 400.0, 0.0).astype(np.float32),
        snr=np.where(echo, np.maximum(70.0 + 5.0 * true, 5.0) * scatter, 0.0).astype(np.float32),
        frame=frame.astype(np.uint32),
        line=(frame // (frames // 2)).astype(np.uint16),
        row=row.astype(np.uint16),
        column=column.astype(np.uint16),
    )


def made_survey(**size: int) -> FlownSurvey:
    """Return the survey over `made_cloud`: two lines, 200 m above the water."""
    cloud = made_cloud(**size)
    frames = np.unique(cloud.frame).astype(np.intp)
    sea = cloud.select(cloud.classification != PointClass.GROUND)
    level = np.column_stack([sea.position[:, :2], np.full(len(sea), LEVEL)])
    surface = PointCloud(**{**sea.columns(), "position": level})
    length = float(np.ptp(cloud.position[:, 0]))
    along = length * (frames + 0.5) / len(frames)
    return FlownSurvey(
        title="A <made> slope",
        description="From land to 9 m & no deeper.",
        water_level=LEVEL,
        bottom=cloud,
        surface=surface,
        positions=np.column_stack([along, np.full(len(frames), 9.0), np.full(len(frames), 200.0)]),
        headings=np.full(len(frames), np.pi / 2.0),
        frame=frames,
        line=frames // (len(frames) // 2),
        map_frame=MapFrame(easting=500000.0, northing=6.0e6, epsg=25832, vertical_epsg=5714),
    )


def made_waveforms(cloud: PointCloud, *, bins: int = 120) -> dict[str, Any]:
    """Return waveforms of every 4th point: pulses at 20 ns and at its depth."""
    marked = cloud.select(np.arange(len(cloud)) % 4 == 1)
    times = np.arange(bins, dtype=np.float64)
    bottom = 20.0 + 9.0 * np.maximum(LEVEL - marked.true_elevation, 0.0)
    light = {
        "surface": 90.0 * np.exp(-(((times - 20.0) / 4.0) ** 2)) + 0.0 * bottom[:, None],
        "column": 9.0 * np.exp(-np.maximum(times - 20.0, 0.0) / 30.0) + 0.0 * bottom[:, None],
        "bottom": 60.0 * np.exp(-(((times - bottom[:, None]) / 4.0) ** 2)),
    }
    scale, coarse = {"least": 1e-4, "step": 0.02}, {"least": 1e-4, "step": 0.2}
    curves = {
        "counts": np.round(sum(light.values())).astype(np.int64),
        **{name: logarithmic(values, **scale) for name, values in light.items()},
        **{
            f"{name}_error": logarithmic(0.1 * light[name], **coarse)
            for name in ("column", "bottom")
        },
        "surface_threshold": np.full_like(light["bottom"], 30).astype(np.int64),
        "bottom_threshold": np.full_like(light["bottom"], 60).astype(np.int64),
    }
    pixels = [
        {
            "frame": int(marked.frame[i]),
            "row": int(marked.row[i]),
            "column": int(marked.column[i]),
            "outcome": "found",
            "firstBin": 0.0,
            "binWidth": 1.0,
            **{axis: float(marked.truth[i, k]) for k, axis in enumerate("xyz")},
            "trueDepth": float(LEVEL - marked.true_elevation[i]),
            "depth": float(marked.depth[i]),
            "error": 0.01,
            "tvu": 0.1,
            "probability": 0.99,
            "background": 0.2,
            "metresPerNs": 0.111,
            "trueSurface": 20.0,
            "foundSurface": 20.1,
            "trueBottom": float(bottom[i]),
            "foundBottom": None,
        }
        for i in range(len(marked))
    ]
    return {
        "pixels": pixels,
        "bins": bins,
        "curves": packed({name: curve.ravel() for name, curve in curves.items()}),
        "light": {"least": 1e-4, "ratio": 1.02},
        "error": {"least": 1e-4, "ratio": 1.2},
        "gateBins": 5,
        "pulses": 1,
    }


@pytest.fixture(scope="session")
def survey_of() -> Callable[..., FlownSurvey]:
    """Make a survey of another size: frames, rows, columns."""
    return made_survey


@pytest.fixture(scope="session")
def waveforms_of() -> Callable[[PointCloud], dict[str, Any]]:
    """Make waveforms of some points of a cloud."""
    return made_waveforms


@pytest.fixture(scope="session")
def flown() -> FlownSurvey:
    return made_survey()


@pytest.fixture(scope="session")
def contents(flown: FlownSurvey) -> dict[str, Any]:
    """What the page of the made survey holds, but for the true seabed."""
    chosen = chosen_points(flown, at_most=10_000)
    found = made_waveforms(chosen["bottom"].cloud)
    return page_contents(flown, chosen, waveforms=found, substrates={1: "sand"})


@pytest.fixture(scope="session")
def page_file(contents: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("page") / "page.html"
    file.write_text(html(contents), encoding="utf-8")
    return file


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Debian's chromium, driven by playwright, drawing without a graphics card."""
    sync_api = pytest.importorskip("playwright.sync_api", reason=MISSING)
    program = next(filter(None, map(shutil.which, BROWSERS)), None)
    if program is None:
        pytest.skip(MISSING)
    with sync_api.sync_playwright() as play:
        found = play.chromium.launch(executable_path=program, args=list(FLAGS))
        yield found
        found.close()
