"""The points of a run by what they stand for."""

from __future__ import annotations

import numpy as np

from survey.cloud.points import PointCloud
from survey.errors import UserError
from survey.products.grids import SOLID_CLASSES
from viewer.run_folder import FlownSurvey


def clouds_of(flown: FlownSurvey) -> dict[str, PointCloud]:
    """Return ``bottom`` with objects and dry ground, ``other`` (no bottom, noise), ``surface``.

    Raises
    ------
    UserError
        If there is no point of bottom or ground.
    """
    solid = np.isin(flown.bottom.classification, SOLID_CLASSES)
    if not solid.any():
        raise UserError(
            "no point of bottom or ground in the run, so there is nothing to show. "
            "See the outcomes in its report.html for the reason"
        )
    return {
        "bottom": flown.bottom.select(solid),
        "other": flown.bottom.select(~solid),
        "surface": flown.surface,
    }
