"""A run made by hand, without light, to score clouds by."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from survey.cloud.georeference import pixel_rays
from survey.cloud.points import Outcome, PixelRecord, PointClass, PointCloud
from survey.cloud.truth import true_targets
from survey.flight.pose import Frame
from survey.preparation import product_settings
from survey.products.frame_file import FrameResult, frame_bytes
from survey.products.run_products import write_products
from survey.run_folder import RunFolder
from survey.scenario import components
from survey.scenario.scenario import Scenario
from terrain.seabed import Seabed
from tests.small_scenario import SLOPE, small_tables

TABLES = small_tables(
    **{
        "mission": {"title": "a benchmark", "seed": 7},
        "flight.speed_m_s": 20.0,
        "camera": {"rows": 8, "columns": 16},
        "seabed": SLOPE,
        "transport.walks_per_pixel": 16,
    }
)


def make_run(folder: Path, some: PointCloud) -> Path:
    """Make a run of two frames of 16 x 8 pixels over a slope from 3 m.

    What the scenario does not say its points have from ``some``.
    """
    scenario = Scenario.from_tables(TABLES, name="reef.toml", folder=folder)
    seabed, flashes = components.seabed(scenario), components.frames(scenario)
    kept = RunFolder.open(folder / "run", scenario)
    for frame in flashes:
        kept.keep(frame.index, frame_bytes(seen(some, scenario, seabed, frame)))
    write_products(
        kept.path,
        read=kept.frame,
        frames=flashes,
        seabed=seabed,
        settings=product_settings(scenario),
    )
    return kept.path


def seen(some: PointCloud, scenario: Scenario, seabed: Seabed, frame: Frame) -> FrameResult:
    """Return a frame that finds every bottom with errors of 5 cm, but one 2 m too high.

    What is not said here the points have from ``some``.
    """
    camera, random = components.camera(scenario), np.random.default_rng(frame.index)
    targets = true_targets(
        seabed=seabed,
        surface=components.sea_surface(scenario),
        water=components.water(scenario),
        pose=frame.pose,
        rays=pixel_rays(camera=camera, pose=frame.pose),
    )
    shape = targets.depth.shape
    row, column = (index.ravel() for index in np.indices(shape))
    truth = targets.position.reshape(-1, 3)
    position = truth + random.normal([0.0, 0.0, -0.03], 0.05, truth.shape)
    position[0, 2] += 2.0
    n = len(truth)
    cloud = replace(
        some.select(np.zeros(n, dtype=np.intp)),
        position=position,
        uncorrected=position,
        truth=truth,
        classification=np.full(n, PointClass.BATHYMETRIC, dtype=np.uint8),
        true_elevation=seabed.elevation_at(position[:, 0], position[:, 1]),
        frame=np.full(n, frame.index, dtype=np.uint32),
        row=row.astype(np.uint16),
        column=column.astype(np.uint16),
    )
    record = PixelRecord(
        true_position=targets.position,
        true_depth=targets.depth,
        detection_probability=np.where(column.reshape(shape) < 15, 0.99, 0.5),
        outcome=np.full(shape, Outcome.FOUND, dtype=np.uint8),
        bottom_counts=np.full(shape, 100.0),
        monte_carlo_relative_error=np.full(shape, 0.05),
    )
    return FrameResult(bottom=cloud, surface=cloud.select(slice(0, 0)), record=record)
