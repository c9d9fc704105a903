"""The section [water] with its layers or its profile turned into a water column."""

from __future__ import annotations

from functools import lru_cache
from math import inf, log
from pathlib import Path
from typing import TYPE_CHECKING, Any

from survey.scenario import water_sections as kinds
from survey.scenario.file_stamp import stamp_of
from survey.scenario.phase_parts import build_phase_function
from survey.scenario.water_parts import build_water

if TYPE_CHECKING:
    from survey.optics.phase import PhaseFunction
    from survey.optics.water import WaterColumn
    from survey.optics.water.cast_file import Cast

BACKSCATTER_STEP = 0.05
"""Relative distance of the backscatter fractions that a profile's phase functions stand for."""


def build_column(given: kinds.WaterSection, *, wavelength_nm: float, folder: Path) -> WaterColumn:
    """Return the water of a section: one water or a profile, with its layers in it.

    Parameters
    ----------
    given : WaterSection
    wavelength_nm : float
        Of the laser [nm].
    folder : Path
        Folder from which files are reached.

    Raises
    ------
    ValueError
        When a file cannot be used or no water is like that.
    """
    from survey.optics.water import WaterColumn

    indices = {"refractive_index": given.refractive_index, "group_index": given.group_index}
    place: dict[str, Any] = {**indices, "wavelength_nm": wavelength_nm, "folder": folder}
    if isinstance(given, kinds.ProfiledSection):
        column = _profiled(given, folder, **indices)
    else:
        column = WaterColumn.uniform(build_water(given, **place))
    for layer in given.layers:
        bottom = inf if layer.to_depth_m is None else layer.to_depth_m
        column = column.with_layer(
            build_water(layer, **place), top=layer.from_depth_m, bottom=bottom
        )
    return column


def cast_of(given: kinds.ProfiledSection, *, folder: Path) -> Cast:
    """Return the cast in the file of a profile.

    Raises
    ------
    ForeignFileError
        With every fault of the file.
    """
    path = folder / given.profile.file
    return _read_cast(path, stamp_of(path))


@lru_cache(maxsize=4)
def _read_cast(path: Path, stamp: tuple[int, int]) -> Cast:
    """Read a cast once; another time or size of the file is another file."""
    from survey.optics.water.cast_file import read_cast

    return read_cast(path)


def _profiled(given: kinds.ProfiledSection, folder: Path, **indices: float) -> WaterColumn:
    from survey.optics.water import profiled_water

    cast = cast_of(given, folder=folder)
    if cast.backscatter_fraction is None:
        phases = [build_phase_function(given.phase_function, folder=folder)] * len(cast.depth)
    else:
        phases = [_of_backscatter(fraction) for fraction in cast.backscatter_fraction]
    return profiled_water(
        depth=cast.depth.tolist(),
        absorption=cast.absorption.tolist(),
        scattering=cast.scattering.tolist(),
        phase_functions=phases,
        **indices,
    )


def _of_backscatter(fraction: float) -> PhaseFunction:
    """Return the particles' phase function of nearly that fraction: few serve a whole profile."""
    return _of_backscatter_step(round(log(fraction) / log(1.0 + BACKSCATTER_STEP)))


@lru_cache(maxsize=128)
def _of_backscatter_step(step: int) -> PhaseFunction:
    from survey.optics.phase import backscatter_reach, fournier_forand_of_backscatter

    low, high = backscatter_reach()
    fraction = (1.0 + BACKSCATTER_STEP) ** step
    return fournier_forand_of_backscatter(min(max(fraction, low), high))
