"""What the points of a page can be coloured by, in whole steps and as the page's JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from survey.cloud.points import PointCloud
from survey.products.depth_colours import LAND
from viewer.attributes import (
    LEAST_SNR,
    MEASURES,
    Attribute,
    measure_attribute,
    snr_attribute,
)
from viewer.web.columns import IntArray, logarithmic, rounded, start_of

STEPS = {"error": 0.005, "tvu": 0.005, "thu": 0.01}
"""To which measures are rounded [m]."""

SNR_STEP = 0.04


def measures_of(cloud: PointCloud) -> tuple[dict[str, IntArray], list[dict[str, Any]]]:
    """Return columns of a cloud in whole steps, and how the page is to show them."""
    columns, shown = {}, []
    for measure in MEASURES:
        values, step = measure.values(cloud), STEPS[measure.name]
        columns[measure.name] = rounded(values, step)
        rounding = {"step": step, "start": start_of(values, step)}
        shown.append(as_json(measure_attribute(measure, values)) | rounding)
    columns["snr"] = logarithmic(cloud.snr, least=LEAST_SNR, step=SNR_STEP)
    ratios = {"least": LEAST_SNR, "ratio": 1.0 + SNR_STEP}
    return columns, [*shown, as_json(snr_attribute(cloud.snr)) | ratios]


def as_json(attribute: Attribute) -> dict[str, Any]:
    """Return how an attribute is shown, as the page reads it."""
    named = {"name": attribute.name, "label": attribute.label}
    if attribute.scale is None:
        return named | {"categories": [asdict(category) for category in attribute.categories]}
    scale = attribute.scale
    return named | {
        "unit": attribute.unit,
        "range": [scale.low, scale.high],
        "palette": list(scale.palette),
        "below": {"colour": LAND, "label": "land"} if scale.land else None,
    }
