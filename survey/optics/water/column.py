"""Water whose coefficients and phase function change with depth, as layers of uniform water."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.optics.phase import PhaseFunction
from survey.optics.water.medium import Water

FloatArray = NDArray[np.float64]

FINEST_STEP = 0.05
"""Relative change of a coefficient within one slice of a continuous profile [1]."""


@dataclass(frozen=True, kw_only=True)
class Layer:
    """Uniform water from a depth ``top`` under mean level [m] down to the next layer."""

    top: float
    water: Water


@dataclass(frozen=True, kw_only=True)
class WaterColumn:
    """Layers of water, the first at the surface, the last without end.

    Parameters
    ----------
    layers : tuple of Layer
        By increasing depth. Light is bent and timed alike in all of them.

    Raises
    ------
    ValueError
        When the first layer does not begin at 0, depths do not increase or indices differ.

    Examples
    --------
    >>> from survey.optics.water import petzold_water
    >>> clear, coastal = (
    ...     petzold_water(kind, refractive_index=1.34, group_index=1.36)
    ...     for kind in ("clear", "coastal")
    ... )
    >>> column = WaterColumn.uniform(clear).with_layer(coastal, top=8.0, bottom=10.0)
    >>> [layer.top for layer in column.layers]
    [0.0, 8.0, 10.0]
    >>> round(float(column.scattered(12.0)), 3)  # 10 m of 0.037 / m, 2 m of 0.219 / m
    0.808
    """

    layers: tuple[Layer, ...]

    def __post_init__(self) -> None:
        tops = [layer.top for layer in self.layers]
        faults = []
        if not tops or tops[0] != 0.0:
            faults.append("the first layer must begin at 0 m")
        if any(not below > above for above, below in pairwise(tops)):
            faults.append("layers must follow each other by increasing depth")
        if (
            len({(layer.water.refractive_index, layer.water.group_index) for layer in self.layers})
            > 1
        ):
            faults.append("all layers must have the same refractive and group index")
        if faults:
            raise ValueError("\n".join(f"water layers: {fault}" for fault in faults))

    @classmethod
    def uniform(cls, water: Water) -> WaterColumn:
        """Return the same water at all depths."""
        return cls(layers=(Layer(top=0.0, water=water),))

    @property
    def surface(self) -> Water:
        """The water right under the surface."""
        return self.layers[0].water

    @property
    def is_uniform(self) -> bool:
        """Whether the water is the same at all depths."""
        return len(self.layers) == 1

    @property
    def refractive_index(self) -> float:
        """Phase index [1]."""
        return self.surface.refractive_index

    @property
    def group_index(self) -> float:
        """Group index [1]."""
        return self.surface.group_index

    @property
    def phase_functions(self) -> list[PhaseFunction]:
        """Every phase function in the column, once."""
        return list(
            {id(p): p for p in (layer.water.phase_function for layer in self.layers)}.values()
        )

    def at(self, depth: float) -> Water:
        """Return the water at a depth [m]."""
        return [layer.water for layer in self.layers if layer.top <= max(depth, 0.0)][-1]

    def absorbed(self, depth: ArrayLike) -> FloatArray:
        """Integral of the absorption coefficient from the surface down to ``depth`` [m], [1]."""
        return self._integral(depth, [layer.water.absorption for layer in self.layers])

    def scattered(self, depth: ArrayLike) -> FloatArray:
        """Integral of the scattering coefficient from the surface down to ``depth`` [m], [1]."""
        return self._integral(depth, [layer.water.scattering for layer in self.layers])

    def mean(self, depth: float) -> Water:
        """Return uniform water with the mean coefficients down to a depth [m].

        Its phase function is that of the layer that scatters most on the way.
        """
        tops = np.minimum([layer.top for layer in self.layers] + [math.inf], depth)
        thickness = np.diff(tops)
        share = thickness * [layer.water.scattering for layer in self.layers]
        return replace(
            self.layers[int(np.argmax(share))].water,
            absorption=float(self.absorbed(depth)) / depth,
            scattering=float(self.scattered(depth)) / depth,
        )

    def with_layer(self, water: Water, *, top: float, bottom: float = math.inf) -> WaterColumn:
        """Return the column with other water between two depths [m]."""
        if not 0.0 <= top < bottom:
            raise ValueError(
                f"water layers: {top:g} to {bottom:g} m: must go down from the surface"
            )
        kept = [layer for layer in self.layers if not top <= layer.top < bottom]
        added = [Layer(top=top, water=water)]
        if bottom < math.inf and all(layer.top != bottom for layer in kept):
            added.append(Layer(top=bottom, water=self.at(bottom)))
        return WaterColumn(layers=tuple(sorted((*kept, *added), key=lambda layer: layer.top)))

    def _integral(self, depth: ArrayLike, coefficients: Sequence[float]) -> FloatArray:
        depth = np.asarray(depth, dtype=np.float64)
        tops = np.array([layer.top for layer in self.layers] + [math.inf])
        inside = np.clip(depth[..., None], tops[:-1], tops[1:]) - tops[:-1]
        return np.asarray(inside @ np.asarray(coefficients))


def profiled_water(
    *,
    depth: Sequence[float],
    absorption: Sequence[float],
    scattering: Sequence[float],
    phase_functions: Sequence[PhaseFunction],
    refractive_index: float,
    group_index: float,
) -> WaterColumn:
    """Return water whose coefficients run straight from depth to depth, as from a cast.

    Sliced so finely that no coefficient changes by more than `FINEST_STEP` within a slice, which
    has their means: optical depths at its ends are exact. Above the first and below the last depth
    the coefficients stay.

    Parameters
    ----------
    depth : sequence of float
        Increasing depths under mean level [m].
    absorption, scattering : sequence of float
        Coefficients there [1/m].
    phase_functions : sequence of PhaseFunction
        At each depth; a slice has that of the nearer end.
    refractive_index, group_index : float
        Phase and group index [1].

    Raises
    ------
    ValueError
        When depths do not increase or a coefficient is negative.

    Examples
    --------
    >>> from survey.optics.phase import average_particle
    >>> column = profiled_water(
    ...     depth=[0.0, 10.0], absorption=[0.1, 0.1], scattering=[0.1, 0.2],
    ...     phase_functions=[average_particle()] * 2, refractive_index=1.34, group_index=1.36,
    ... )
    >>> round(float(column.scattered(10.0)), 9), len(column.layers)
    (1.5, 11)
    """
    indices = {"refractive_index": refractive_index, "group_index": group_index}
    layers: list[Layer] = []
    for i, (upper, lower) in enumerate(pairwise(depth)):
        ends = [(v[i], v[i + 1]) for v in (absorption, scattering)]
        slices = max(1, *(math.ceil(abs(b - a) / (FINEST_STEP * max(a, b, 1e-9))) for a, b in ends))
        middle = (np.arange(slices) + 0.5) / slices
        layers += [
            Layer(
                top=0.0
                if not layers and i == 0 and j == 0
                else upper + (lower - upper) * j / slices,
                water=Water(
                    absorption=float(ends[0][0] + (ends[0][1] - ends[0][0]) * middle[j]),
                    scattering=float(ends[1][0] + (ends[1][1] - ends[1][0]) * middle[j]),
                    phase_function=phase_functions[i if middle[j] < 0.5 else i + 1],
                    **indices,
                ),
            )
            for j in range(slices)
        ]
    last = Water(
        absorption=absorption[-1], scattering=scattering[-1],
        phase_function=phase_functions[-1], **indices,
    )  # fmt: skip
    return WaterColumn(layers=(*layers, Layer(top=depth[-1] if layers else 0.0, water=last)))
