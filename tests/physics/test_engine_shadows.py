"""What stands in the way of light: walls under water, roofs above it."""

from __future__ import annotations

import numpy as np
import trimesh

from survey.optics.phase import molecular
from terrain.seabed import Seabed
from tests.physics.conftest import FRAME

HEIGHT, INDEX = 200.0, 1.33
ROOF = np.array([[-200, -200, 5], [0, -200, 5], [0, 200, 5], [-200, 200, 5]], dtype=np.float64)
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
