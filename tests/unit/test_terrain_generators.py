"""Generated seabeds have the stated shape, on the stated side, with the stated statistics."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from terrain.generators import Ground, channel, plane, rough, sandbar, slope
from terrain.map_frame import MapFrame
from terrain.roughness import Roughness

FRAME = MapFrame(easting=500000.0, northing=6000000.0, epsg=25832, vertical_epsg=5714)


def ground(**changes: Any) -> Ground:
    keys: dict[str, Any] = {"length": 400.0, "width": 200.0, "reflectance": 0.1}
    return Ground(map_frame=FRAME, **(keys | changes))


def test_a_plane_is_few_triangles_and_level() -> None:
    flat = plane(ground=ground(), depth=12.5)
    assert len(flat.mesh.faces) == 4
    np.testing.assert_array_equal(flat.mesh.vertices[:, 2], -12.5)
    assert flat.mesh.area == pytest.approx(80_000.0)
    np.testing.assert_array_equal(flat.mesh.face_normals[:, 2], 1.0)


def test_the_axis_turns_clockwise_from_north() -> None:
    """Axis 90 degrees: the long side lies east-west, and the slope falls to the east."""
    falling = slope(ground=ground(axis=np.pi / 2, centre=(50.0, -20.0)), depth=10.0, gradient=0.02)
    np.testing.assert_allclose(falling.mesh.extents[:2], [400.0, 200.0])
    x = np.array([-149.0, 50.0, 249.0])
    np.testing.assert_allclose(falling.elevation_at(x, -20.0), [-6.02, -10.0, -13.98], atol=1e-9)
    to_north = slope(ground=ground(), depth=10.0, gradient=0.02)
    assert to_north.elevation_at(0.0, 100.0) == pytest.approx(-12.0)


def test_a_turned_rectangle_is_still_a_rectangle() -> None:
    turned = plane(ground=ground(axis=0.5, centre=(10.0, 20.0)), depth=3.0, spacing=50.0)
    assert turned.mesh.area == pytest.approx(80_000.0)
    along, right = np.array([np.sin(0.5), np.cos(0.5)]), np.array([np.cos(0.5), -np.sin(0.5)])
    centre = np.array([10.0, 20.0])
    inside = centre + np.outer([199, 0, 0, -199], along) + np.outer([0, 99, -99, 99], right)
    outside = centre + np.outer([201, 0, 0], along) + np.outer([0, 101, -101], right)
    assert np.isfinite(turned.elevation_at(*inside.T)).all()
    assert np.isnan(turned.elevation_at(*outside.T)).all()


def test_a_bar_lies_off_the_shore_and_the_beach_ends() -> None:
    bed = sandbar(
        ground=ground(),
        shoreline=-100.0,
        gradient=0.03,
        bar_distance=120.0,
        bar_height=1.5,
        bar_width=15.0,
        beach_gradient=0.1,
        beach_height=4.0,
        spacing=2.0,
    )
    z = bed.elevation_at(7.0, np.array([-199.0, -120.0, -100.0, 20.0, 100.0]))
    np.testing.assert_allclose(z, [4.0, 2.0, 0.0, -3.6 + 1.5, -6.0], atol=0.02)
    profile = bed.elevation_at(0.0, np.arange(-90.0, 199.0))
    assert (np.diff(profile) > 0).any()  # the landward side of the bar rises seaward


def test_a_channel_is_as_wide_and_deep_as_stated_across_its_axis() -> None:
    bed = channel(
        ground=ground(axis=np.pi / 2, length=200.0, width=200.0),
        depth=8.0,
        channel_depth=12.0,
        bottom_width=40.0,
        side_gradient=0.25,
        spacing=1.0,
    )
    z = bed.elevation_at(33.3, np.array([0.0, 19.9, -19.9, 28.0, 36.1, -60.0]))
    np.testing.assert_allclose(z, [-12, -12, -12, -10, -8, -8], atol=0.02)
    with pytest.raises(ValueError, match="channel_depth"):
        channel(
            ground=ground(),
            depth=8.0,
            channel_depth=7.0,
            bottom_width=1.0,
            side_gradient=1.0,
            spacing=1.0,
        )


def test_roughness_has_its_rms_its_slope_and_no_long_waves() -> None:
    relief = Roughness(rms=0.2, spectral_slope=3.2, longest_wavelength=40.0, seed=3)
    z = relief.field((512, 512), spacing=0.5)
    assert z.std() == pytest.approx(0.2)
    assert abs(z.mean()) < 1e-12
    k = np.hypot(np.fft.fftfreq(512, 0.5), np.fft.fftfreq(512, 0.5)[:, None])
    power = np.abs(np.fft.fft2(z)) ** 2
    assert power[k < 1 / 40.0 - 1e-9].max() < 1e-12 * power.max()
    band = (k > 0.05) & (k < 0.9)
    fitted = np.polyfit(np.log(k[band]), np.log(power[band]), 1)[0]
    assert fitted == pytest.approx(-3.2, abs=0.05)


def test_the_relief_is_as_rough_along_as_across() -> None:
    z = Roughness(rms=0.2, spectral_slope=3.0, longest_wavelength=10.0, seed=4).field(
        (400, 600), spacing=0.5
    )
    along, across = np.diff(z, axis=0).std(), np.diff(z, axis=1).std()
    assert along == pytest.approx(across, rel=0.03)


def test_a_seed_fixes_the_relief() -> None:
    def relief(seed: int) -> np.ndarray:
        roughness = Roughness(rms=0.2, spectral_slope=3.0, longest_wavelength=50.0, seed=seed)
        bed = rough(ground=ground(roughness=roughness), depth=10.0, spacing=2.0)
        assert "Synthetic roughness of 0.2 m" in bed.source
        return np.asarray(bed.mesh.vertices)

    np.testing.assert_array_equal(relief(1), relief(1))
    assert np.abs(relief(1) - relief(2)).max() > 0.2
    assert relief(1)[:, 2].mean() == pytest.approx(-10.0)


def test_what_cannot_be_made_is_refused() -> None:
    with pytest.raises(ValueError, match="no roughness"):
        rough(ground=ground(), depth=1.0, spacing=1.0)
    with pytest.raises(ValueError, match="rms") as refused:
        Roughness(rms=-1.0, spectral_slope=0.0, longest_wavelength=1.0, seed=1)
    assert len(str(refused.value).splitlines()) == 2
    waves = Roughness(rms=0.1, spectral_slope=3.0, longest_wavelength=1.0, seed=1)
    with pytest.raises(ValueError, match="not resolved"):
        waves.field((50, 50), spacing=2.0)
    with pytest.raises(ValueError, match="needs a spacing"):
        plane(ground=ground(roughness=waves), depth=1.0)
