"""Seabeds with forms of stated statistics: sand ripples, a reef."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from terrain.generators import Ground, shaped
from terrain.roughness import Roughness
from terrain.seabed import Seabed
from terrain.substrate import Substrate

FloatArray = NDArray[np.float64]

LEAST_CELLS = 8
WANDER_WAVELENGTHS = 30.0
WANDER_SLOPE = 5.0
REEF_BEGINS = 0.02


def ripples(
    *,
    ground: Ground,
    depth: float,
    wavelength: float,
    height: float,
    asymmetry: float = 1.0,
    crest_wander: float = 0.0,
    seed: int = 1,
    spacing: float,
) -> Seabed:
    """Return a level seabed with ripples whose crests run along the axis.

    Both flanks are half a cosine: elevations range over exactly ``height`` about the depth, and
    their r.m.s. is height / sqrt(8) whatever the asymmetry.

    Parameters
    ----------
    depth : float
        Mean [m].
    wavelength, height : float
        From crest to crest, and from trough to crest [m]. Wave-formed ripples have a height of
        some 0.15 wavelengths or less.
    asymmetry : float
        Length of the gentle flank over that of the steep one, which falls to the right of the
        axis; 1 is symmetrical [1].
    crest_wander : float
        R.m.s. displacement of the crests from straight lines, smooth over many wavelengths [m].
    seed : int
        Of the wander.
    spacing : float
        Side of the cells [m].

    Raises
    ------
    ValueError
        When a size is not positive, the asymmetry below 1, or fewer than 8 cells go on the steep
        flank and its counterpart.

    Examples
    --------
    >>> from terrain.map_frame import MapFrame
    >>> frame = MapFrame(easting=5e5, northing=6e6, epsg=25832, vertical_epsg=5714)
    >>> ground = Ground(map_frame=frame, length=10.0, width=20.0, reflectance=0.2)
    >>> bed = ripples(ground=ground, depth=5.0, wavelength=4.0, height=0.5, spacing=0.1)
    >>> bed.mesh.vertices[:, 2].min().round(3), bed.mesh.vertices[:, 2].max().round(3)
    (np.float64(-5.25), np.float64(-4.75))
    """
    if not (wavelength > 0.0 and height > 0.0 and asymmetry >= 1.0 and crest_wander >= 0.0):
        raise ValueError(
            "seabed: ripples: wavelength and height must be positive, asymmetry at least 1"
        )
    widest = widest_ripple_spacing(wavelength=wavelength, asymmetry=asymmetry)
    if spacing > widest:
        raise ValueError(f"seabed: ripples: spacing {spacing:g} m must be at most {widest:.3g} m")
    gentle = asymmetry / (1.0 + asymmetry)

    def profile(s: FloatArray, c: FloatArray) -> FloatArray:
        shift = _wander(s, c, wavelength, crest_wander, seed)
        phase = ((c + shift) / wavelength) % 1.0
        rising = -np.cos(np.pi * phase / gentle)
        falling = np.cos(np.pi * (phase - gentle) / (1.0 - gentle))
        return np.asarray(-depth + 0.5 * height * np.where(phase < gentle, rising, falling))

    return shaped(
        ground=ground,
        profile=profile,
        spacing=spacing,
        sentence=f"Generated ripples of {wavelength:g} m, {height:g} m high, "
        f"flanks {asymmetry:g} to 1, in a seabed {depth:g} m deep.",
    )


def widest_ripple_spacing(*, wavelength: float, asymmetry: float) -> float:
    """Return the widest cells that show ripples: four on the steep flank [m]."""
    return 2.0 * wavelength / (1.0 + asymmetry) / LEAST_CELLS


def _wander(
    s: FloatArray, c: FloatArray, wavelength: float, crest_wander: float, seed: int
) -> FloatArray:
    """Return by how much crests are displaced (rows, cols) [m]."""
    shape = (s.shape[0], c.shape[1])
    if crest_wander == 0.0:
        return np.zeros(shape)
    field = Roughness(
        rms=crest_wander,
        spectral_slope=WANDER_SLOPE,
        longest_wavelength=WANDER_WAVELENGTHS * wavelength,
        seed=seed,
    )
    return field.field(shape, spacing=float(s[1, 0] - s[0, 0]))


def reef(
    *,
    ground: Ground,
    depth: float,
    top_depth: float,
    top_width: float,
    side_gradient: float,
    relief: Roughness,
    coral: Substrate,
    spacing: float,
) -> Seabed:
    """Return a level seabed with a flat-topped reef along the axis, rough as reefs are.

    On the top the relief has its r.m.s. and the slope of its power spectrum; down the sides it
    fades with the height above the bed. Measured reefs and rocky shores have 0.04 to 0.77 m r.m.s.
    and a power law from 0.1 m to several metres (Sous et al. 2020, Earth Surface Processes and
    Landforms 45, 3042; Sous et al. 2024, PLOS ONE 19, e0303422).

    Parameters
    ----------
    depth, top_depth : float
        Beside and on the reef, relief apart [m].
    top_width : float
        [m].
    side_gradient : float
        Rise of the sides [1].
    relief : Roughness
        On the top.
    coral : Substrate
        What the reef is made of.
    spacing : float
        Side of the cells [m].

    Raises
    ------
    ValueError
        When the top is no shallower than the bed, or a size is not positive.
    """
    if not (top_depth < depth and side_gradient > 0.0 and top_width > 0.0):
        raise ValueError(
            "seabed: reef: top_depth must be less than depth, side_gradient and top_width positive"
        )

    def share(c: FloatArray) -> FloatArray:
        down = side_gradient * np.maximum(np.abs(c) - 0.5 * top_width, 0.0)
        return np.maximum(1.0 - down / (depth - top_depth), 0.0)

    def profile(s: FloatArray, c: FloatArray) -> FloatArray:
        rough = relief.field((s.shape[0], c.shape[1]), spacing=float(s[1, 0] - s[0, 0]))
        return np.asarray(-depth + share(c) * (depth - top_depth + rough))

    bed = shaped(
        ground=ground,
        profile=profile,
        spacing=spacing,
        sentence=f"Generated reef {top_depth:g} m deep in a seabed {depth:g} m deep, relief of "
        f"{relief.rms:g} m r.m.s., spectral slope {relief.spectral_slope:g}, seed {relief.seed}.",
    )
    centres = np.asarray(bed.mesh.triangles_center)
    _, across = ground.along_across(centres[:, 0], centres[:, 1])
    return bed.painted(share(across) > REEF_BEGINS, coral)
