"""Water whose coefficients and phase function change with depth, as layers of uniform water."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from survey.optics.phase import PhaseFunction
from survey.optics.water.medium import Water

FloatArray = NDArray[np.float64]

FINEST_STEP = 0.05
"""Change of a coefficient within a slice, over the larger of the profile's values beside it [1]."""
ROUNDING = 1e-9


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

    @classmethod
    def of(cls, water: Water | WaterColumn) -> WaterColumn:
        """Return a column as it is, and of one water the column that it fills."""
        return cls.uniform(water) if isinstance(water, Water) else water

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

    def integral(self, depth: ArrayLike, coefficient: Callable[[Water], float]) -> FloatArray:
        """Integral of any coefficient [1/m] of the waters from the surface down to depths [m], [1].

        Examples
        --------
        >>> from survey.optics.water import petzold_water
        >>> from survey.optics.water.apparent import diffuse_attenuation
        >>> column = WaterColumn.uniform(
        ...     petzold_water("coastal", refractive_index=1.34, group_index=1.36))
        >>> column.integral([0.0, 10.0], diffuse_attenuation).round(2).tolist()
        [0.0, 1.9]
        """
        depth = np.asarray(depth, dtype=np.float64)
        tops = np.array([layer.top for layer in self.layers] + [math.inf])
        inside = np.clip(depth[..., None], tops[:-1], tops[1:]) - tops[:-1]
        return np.asarray(inside @ np.array([coefficient(layer.water) for layer in self.layers]))

    def absorbed(self, depth: ArrayLike) -> FloatArray:
        """Integral of the absorption coefficient from the surface down to ``depth`` [m], [1]."""
        return self.integral(depth, lambda water: water.absorption)

    def scattered(self, depth: ArrayLike) -> FloatArray:
        """Integral of the scattering coefficient from the surface down to ``depth`` [m], [1]."""
        return self.integral(depth, lambda water: water.scattering)

    def attenuated(self, depth: ArrayLike) -> FloatArray:
        """Integral of the beam attenuation from the surface down to ``depth`` [m], [1]."""
        return self.integral(depth, lambda water: water.attenuation)

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
    the coefficients stay as they are there.

    Parameters
    ----------
    depth : sequence of float
        Increasing depths under mean level, the first not above it [m].
    absorption, scattering : sequence of float
        Coefficients there [1/m].
    phase_functions : sequence of PhaseFunction
        At each depth; a slice has that of the nearer end.
    refractive_index, group_index : float
        Phase and group index [1].

    Raises
    ------
    ValueError
        When depths do not increase from the surface or a coefficient is negative.

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
    if depth[0] < 0.0 or any(not below > above for above, below in pairwise(depth)):
        raise ValueError("water profile: depths must increase from the surface down")
    tops = _slices(np.array(depth), np.array([absorption, scattering]))
    middle = np.append(0.5 * (tops[1:] + tops[:-1]), depth[-1])
    nearest = np.rint(np.interp(middle, depth, np.arange(len(depth)))).astype(np.int64)
    rows = zip(
        tops.tolist(),
        np.interp(middle, depth, absorption).tolist(),
        np.interp(middle, depth, scattering).tolist(),
        [phase_functions[i] for i in nearest],
        strict=True,
    )
    return WaterColumn(
        layers=tuple(
            Layer(
                top=top,
                water=Water(
                    absorption=a,
                    scattering=b,
                    phase_function=phase,
                    refractive_index=refractive_index,
                    group_index=group_index,
                ),
            )
            for top, a, b, phase in rows
        )
    )


def _slices(depth: FloatArray, coefficients: FloatArray) -> FloatArray:
    """Return the tops of the slices of a profile, from the surface to its last depth."""
    larger = np.maximum(coefficients[:, 1:], coefficients[:, :-1])
    change = np.abs(np.diff(coefficients)) / np.where(larger > 0.0, larger, 1.0)
    counts = np.ceil(np.maximum(change.max(axis=0, initial=0.0) / FINEST_STEP - ROUNDING, 1.0))
    within = [
        np.linspace(upper, lower, int(count), endpoint=False)
        for (upper, lower), count in zip(pairwise(depth), counts, strict=True)
    ]
    above = [0.0] if depth[0] > 0.0 else []
    return np.concatenate([above, *within, depth[-1:]])
