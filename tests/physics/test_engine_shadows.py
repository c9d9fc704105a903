"""What stands in the way of light: walls under water, roofs above it."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from scipy.constants import speed_of_light

from survey.optics.phase import molecular
from terrain.seabed import Seabed
from tests.physics.conftest import FRAME

HEIGHT, INDEX = 200.0, 1.33
SURELY_WEST, SURELY_EAST = np.s_[1:14, 1:-1], np.s_[18:-1, 1:-1]
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def ring(half_side, elevation):
    """Return the corners of a level square, counter-clockwise."""
    return np.column_stack([half_side * CORNERS, np.full(4, elevation)])


def seabed_of(parts):
    """Return a seabed of quadrilaterals (4, 3), each with its reflectance."""
    corners = np.concatenate([corners for corners, _ in parts])
    faces = [[[i, i + 1, i + 2], [i, i + 2, i + 3]] for i in range(0, len(corners), 4)]
    reflectance = np.repeat([reflectance for _, reflectance in parts], 2)
    return Seabed(
        mesh=trimesh.Trimesh(corners, np.concatenate(faces), process=False),
        reflectance=reflectance.astype(np.float64),
        is_object=np.zeros(len(reflectance), dtype=bool),
        map_frame=FRAME,
        source="Made by hand.",
    )


def shaft(*, half_side, top, floor, reflectance):
    """Return a black plateau with a square black shaft in it and a bright floor down there."""
    outer, edge, foot = ring(200.0, -top), ring(half_side, -top), ring(half_side, -floor)
    parts = []
    for upper, lower in ((outer, edge), (edge, foot)):
        parts += [
            (np.stack([upper[i - 1], upper[i], lower[i], lower[i - 1]]), 0.0) for i in range(4)
        ]
    return seabed_of([*parts, (foot, reflectance)])


def test_down_in_a_shaft_there_is_hardly_any_scattered_light(engine_of, nadir):
    """Scattered light of all directions would add 30 to 50 %; the shaft's own adds 0 to 15 %.

    Molecular scattering, b z = 1; the shaft is 1.2 m wide and 12 m deep. Expected: the lidar
    equation with c; four pixels at nadir, one standard error 2 %.
    """
    depth, rho, scattering = 13.0, 0.5, 0.08
    engine = engine_of(
        seabed=shaft(half_side=0.6, top=1.0, floor=depth, reflectance=rho),
        absorption=0.02, scattering=scattering, phase_function=molecular(), wind_speed=0.0,
        shape=(24, 24), pixel_tangent=0.0025, walks_per_pixel=256,
    )  # fmt: skip
    flashes = [engine.flash(pose=nadir, frame=frame) for frame in range(8)]
    echo = np.mean([flash.origin("bottom").sum(axis=-1) for flash in flashes], axis=0)
    transmitted = 1.0 - ((INDEX - 1.0) / (INDEX + 1.0)) ** 2
    lit = engine.photo_electrons / echo.size * transmitted**2 * rho / np.pi
    closed = lit * engine.receiver.aperture_area / (INDEX * HEIGHT + depth) ** 2
    closed *= np.exp(-2.0 * engine.water.surface.attenuation * depth)
    assert 0.95 < echo[11:13, 11:13].mean() / closed < 1.2
    assert echo[:10].sum() < 0.05 * echo.sum()


def plate(elevation):
    """Return the corners of a level plate over the western half of the scene."""
    corners = [[-200.0, -200.0], [0.0, -200.0], [0.0, 200.0], [-200.0, 200.0]]
    return np.column_stack([corners, np.full(4, elevation)])


@pytest.mark.parametrize("elevation", [5.0, -5.0])
def test_a_roof_is_seen_and_what_lies_under_it_is_not(engine_of, nadir, elevation):
    """A plate in the west, 5 m over the water or 5 m under it, over a bottom of 10 m; b = 0.

    Rationale: an overhang: the same place has two faces, one in the other's shadow.
    Expected: in the west rho / pi E A cos^4 / H^2 of the dry roof, or a bottom of 5 m, and less
    than 0.5 % after it, by way of the surface; in the east what there is without a roof. Each pixel
    within 1 %, the west within 0.1 %; the bottom below would add a fifth.
    Source: the lidar equation.
    """
    floor, rho = (ring(200.0, -10.0), 0.1), 0.3
    given = {"scattering": 0.0, "wind_speed": 0.0, "walks_per_pixel": 128, "pulse_fwhm": 1e-15}

    def flash(seabed):
        return engine_of(seabed=seabed, **given).flash(pose=nadir, frame=0)

    roofed, bare = flash(seabed_of([(plate(elevation), rho), floor])), flash(seabed_of([floor]))
    echo = roofed.origin("bottom").sum(axis=-1)
    beside = bare.origin("bottom").sum(axis=-1)[SURELY_EAST]
    assert echo[SURELY_EAST] == pytest.approx(beside, rel=0.01)
    engine = engine_of(**given)
    if elevation > 0.0:
        cosine = 1.0 / np.sqrt(1.0 + sum(t**2 for t in engine.camera.pixel_centres()))
        etendue = engine.receiver.aperture_area * cosine**4 / (HEIGHT - elevation) ** 2
        expected = rho / np.pi * engine.photo_electrons / echo.size * etendue
    else:
        expected = flash(seabed_of([(ring(200.0, elevation), rho)])).origin("bottom").sum(axis=-1)
    assert echo[SURELY_WEST] == pytest.approx(expected[SURELY_WEST], rel=0.01)
    assert echo[SURELY_WEST].sum() == pytest.approx(expected[SURELY_WEST].sum(), rel=0.001)
    in_water = INDEX * max(0.0, -elevation)
    ways = (HEIGHT - max(0.0, elevation) + in_water) * np.array([1.0, 1.06])
    after = roofed.times > 2.0 * ways[1] / speed_of_light + engine.receiver.bin_width
    before = roofed.times < 2.0 * ways[0] / speed_of_light - engine.receiver.bin_width
    light = roofed.origin("bottom")[SURELY_WEST]
    assert light[..., before].sum() == 0.0
    assert light[..., after].sum() < (0.005 if elevation < 0.0 else 1e-12) * light.sum()
