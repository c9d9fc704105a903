"""From attributes of points to their colours."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from survey.products.depth_colours import LAND
from viewer.attributes import (
    MEASURES,
    NO_VALUE,
    Attribute,
    categories_of,
    depth_attribute,
    frame_attribute,
    measure_attribute,
    outcome_attribute,
    snr_attribute,
)
from viewer.desktop.content import Content
from viewer.desktop.state import Layer
from viewer.labels import SEA

Colours = NDArray[np.uint8]
Values = NDArray[Any]
CODES: dict[str, Callable[[PointCloud], Values]] = {
    "class": lambda cloud: cloud.classification,
    "cause": lambda cloud: cloud.cause,
    "substrate": lambda cloud: cloud.substrate,
    "line": lambda cloud: cloud.line,
}
SEA_HAS = {"error", "tvu", "thu", "snr", "frame", "line"}
PIXELS_HAVE = {"class", "frame", "line", "outcome"}
"""What points of the sea and pixels without a bottom can be coloured by."""

PLAIN = {Layer.SURFACE: SEA, Layer.OTHER: NO_VALUE}


class Colouring:
    """Gives points their colours; what was computed once is remembered.

    Parameters
    ----------
    content : Content
    """

    def __init__(self, content: Content) -> None:
        self._content = content
        self.attribute = cache(self._attribute)
        self._values: dict[tuple[str, Layer], Values] = {}

    def values(self, name: str, layer: Layer) -> Values | None:
        """Return an attribute's values (n,) of a layer's points, None where it has none."""
        if layer is Layer.SURFACE and name not in SEA_HAS:
            return None
        if layer is Layer.OTHER and name not in PIXELS_HAVE:
            return None
        if (name, layer) not in self._values:
            self._values = {key: kept for key, kept in self._values.items() if key[0] == name}
            self._values[name, layer] = self._of(name, self._content.clouds[layer])
        return self._values[name, layer]

    def colours(self, name: str, layer: Layer, which: NDArray[np.intp]) -> Colours:
        """Return the colours (k, 3) of some points of a layer."""
        values = self.values(name, layer)
        if values is None:
            return np.tile(_rgb((PLAIN[layer],)), (len(which), 1))
        return painted(self.attribute(name), values[which])

    def _of(self, name: str, cloud: PointCloud) -> Values:
        measures = {measure.name: measure.values for measure in MEASURES}
        if name in measures:
            return measures[name](cloud)
        if name in CODES:
            return CODES[name](cloud)
        if name == "outcome":
            return outcomes_of(cloud, self._content)
        if name == "depth":
            return np.asarray(self._content.flown.water_level - cloud.position[:, 2])
        return np.where(cloud.snr > 0.0, cloud.snr, np.nan) if name == "snr" else cloud.frame

    def _attribute(self, name: str) -> Attribute:
        whole, bottom = self._content.flown.bottom, self._content.bottom
        if name in CODES:
            seabed = self._content.seabed
            kinds = categories_of(whole, seabed.substrate_names if seabed else {})
            return next(kind for kind in kinds if kind.name == name)
        if name == "outcome":
            return outcome_attribute(outcomes_of(whole, self._content))
        if name == "snr":
            return snr_attribute(bottom.snr)
        if name == "frame":
            return frame_attribute(self._content.flown.frame)
        values = self._of(name, bottom)
        if name == "depth":
            return depth_attribute(values)
        measure = next(measure for measure in MEASURES if measure.name == name)
        return measure_attribute(measure, values)


def outcomes_of(cloud: PointCloud, content: Content) -> NDArray[np.uint8]:
    """Return what became of the bottom in the pixel of every point (n,)."""
    found = np.zeros(len(cloud), dtype=np.uint8)
    order = np.argsort(cloud.frame, kind="stable")
    frames, starts = np.unique(cloud.frame[order], return_index=True)
    for frame, members in zip(frames, np.split(order, starts[1:]), strict=True):
        outcome = content.outcomes[int(frame)]
        found[members] = outcome[cloud.row[members], cloud.column[members]]
    return found


def painted(attribute: Attribute, values: Values) -> Colours:
    """Return the colours (n, 3) of an attribute's values."""
    if attribute.scale is None:
        codes = np.array([category.code for category in attribute.categories])
        table = _rgb((*(category.colour for category in attribute.categories), NO_VALUE))
        place = np.minimum(np.searchsorted(codes, values), len(codes) - 1)
        return np.asarray(table[np.where(codes[place] == values, place, len(codes))])
    scale = attribute.scale
    table = _rgb((*scale.palette, LAND, NO_VALUE))
    share = shares(attribute, values)
    known = np.isfinite(share)
    last = len(scale.palette) - 1
    place = np.round(np.where(known, np.clip(share, 0.0, 1.0), 0.0) * last).astype(np.intp)
    if scale.land:
        place[np.asarray(values) <= 0.0] = last + 1
    place[~known] = last + 2
    return np.asarray(table[place])


def shares(attribute: Attribute, values: Values) -> NDArray[np.float64]:
    """Return where values lie on an attribute's scale, 0 to 1 between its ends."""
    scale = attribute.scale
    if scale is None:
        raise ValueError(f"{attribute.name}: has categories, no scale")
    numbers = np.asarray(values, np.float64)
    if scale.logarithmic:
        return np.asarray(np.log(numbers / scale.low) / np.log(scale.high / scale.low))
    return np.asarray((numbers - scale.low) / (scale.high - scale.low))


def _rgb(colours: tuple[str, ...]) -> Colours:
    return np.array(
        [[int(colour[i : i + 2], 16) for i in (1, 3, 5)] for colour in colours], dtype=np.uint8
    )
