"""A finished run as the window shows it: clouds, flashes, seabed, and how it is seen at first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from survey.errors import UserError
from survey.labelled.flown_run import FlownRun
from survey.products.frame_file import read_frame
from survey.run_folder import frame_path
from survey.scenario import components
from terrain.seabed import Seabed
from viewer.clouds import clouds_of
from viewer.desktop.orbit import Orbit
from viewer.desktop.state import Layer, ViewState
from viewer.flashes import Flashes, flashes_of
from viewer.run_folder import FlownSurvey, read_run
from viewer.scene import median_spacing, stretched
from viewer.view import exaggeration, long_axis, oblique_view

FloatArray = NDArray[np.float64]
CLOUDS = {Layer.BOTTOM: "bottom", Layer.OTHER: "other", Layer.SURFACE: "surface"}
MARGINS = (60, 300, 110, 100)
"""Kept free for words and legend, left, right, below, above [pixels]."""

SAMPLE = 200_000
"""So many points suffice to find spacing and extent."""


@dataclass(frozen=True, kw_only=True)
class Content:
    """All that the window needs of a run.

    Parameters
    ----------
    flown : FlownSurvey
    clouds : mapping of Layer to PointCloud
    flashes : Flashes
    seabed : Seabed, optional
        The true one, where its files are at hand.
    run : FlownRun, optional
        To fly frames again.
    missing : tuple of str
        What cannot be shown, in sentences.
    """

    flown: FlownSurvey
    clouds: Mapping[Layer, PointCloud]
    flashes: Flashes
    seabed: Seabed | None = None
    run: FlownRun | None = None
    missing: tuple[str, ...] = field(default=())

    @classmethod
    def of(
        cls,
        flown: FlownSurvey,
        *,
        run: FlownRun | None = None,
        seabed: Seabed | None = None,
        missing: tuple[str, ...] = (),
    ) -> Content:
        """Return the content of a run that was read.

        Raises
        ------
        UserError
            If there is no point of bottom or ground.
        """
        clouds = clouds_of(flown)
        return cls(
            flown=flown,
            clouds={layer: clouds[name] for layer, name in CLOUDS.items()},
            flashes=flashes_of(flown),
            seabed=seabed,
            run=run,
            missing=missing,
        )

    @cached_property
    def spacing(self) -> float:
        """Typical distance of a bottom point to its fourth neighbour [m]."""
        places = self.clouds[Layer.BOTTOM].position[:, :2]
        thinned = np.sqrt(max(len(places) / SAMPLE, 1.0))
        lot = np.random.default_rng(0).permutation(len(places))[:SAMPLE]
        return median_spacing(places[lot]) / float(thinned)

    @cached_property
    def first_factor(self) -> float:
        """The factor for heights at first, that of the pictures."""
        bottom = self.clouds[Layer.BOTTOM].position
        low, high = np.percentile(bottom[:, 2], [0.5, 99.5])
        length = float(np.ptp(bottom[:, :2] @ self.axis))
        return exaggeration(max(high, self.flown.water_level) - low, length)

    @cached_property
    def axis(self) -> FloatArray:
        """Unit vector (2,) along the survey, towards its deep end."""
        bottom = self.clouds[Layer.BOTTOM].position
        return long_axis(bottom[:, :2], bottom[:, 2])

    def first_state(self, size: tuple[int, int]) -> ViewState:
        """Return how the run is seen at first in a window of a size [pixels]."""
        places = self.clouds[Layer.BOTTOM].position[:: max(len(self.bottom) // SAMPLE, 1)]
        seen = stretched(places, water_level=self.flown.water_level, exaggeration=self.first_factor)
        contents = np.vstack([seen, self.flashes.position])
        view = oblique_view(contents, axis=self.axis, size=size, margins=MARGINS)
        home = Orbit.of(view)
        return ViewState(
            home=home,
            orbit=home,
            frames=len(self.flashes),
            exaggeration=self.first_factor,
            frame=len(self.flashes) // 2,
        )

    @property
    def bottom(self) -> PointCloud:
        """Points of bottom, objects and dry ground."""
        return self.clouds[Layer.BOTTOM]

    @cached_property
    def outcomes(self) -> Mapping[int, NDArray[np.uint8]]:
        """What became of the bottom in every pixel (rows, columns), by frame.

        Raises
        ------
        UserError
            If the run's frames are not at hand.
        """
        if self.run is None:
            raise UserError("outcomes stand in the run's frames, and these are not here")
        return {
            index: read_frame(frame_path(self.run.folder, index)).record.outcome
            for index in self.run.whole
        }


def read_content(folder: Path) -> Content:
    """Read a finished run; the true seabed and the frames' files may be missing.

    Raises
    ------
    FileNotFoundError
        If the folder or a product that is drawn is missing.
    ValueError
        If a file is not what bathyflash writes, or there is no point of the bottom.
    """
    run, flown = FlownRun.open(folder), read_run(folder)
    try:
        return Content.of(flown, run=run, seabed=components.seabed(run.scenario))
    except UserError:
        raise
    except (OSError, ValueError) as fault:
        return Content.of(flown, run=run, missing=(f"the true seabed is left out: {fault}",))
