"""Ripples, reefs, boulders and pipelines have the statistics that they state."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from terrain.bedforms import reef, ripples
from terrain.boulder_field import BoulderField
from terrain.generators import Ground, plane, slope
from terrain.map_frame import MapFrame
from terrain.pipeline import FreeSpan, pipeline
from terrain.raycast import build_grid, cast_rays
from terrain.roughness import Roughness
from terrain.substrate import known_substrates

FRAME = MapFrame(easting=500000.0, northing=6000000.0, epsg=25832, vertical_epsg=5714)
CORAL = known_substrates()["coral"]


def ground(**changes: Any) -> Ground:
    keys: dict[str, Any] = {"length": 60.0, "width": 120.0, "reflectance": 0.2}
    return Ground(map_frame=FRAME, **(keys | changes))


@pytest.mark.parametrize("asymmetry", [1.0, 2.5])
def test_ripples_have_their_height_rms_wavelength_and_flanks(asymmetry: float) -> None:
    strip = ground(length=3.0)
    bed = ripples(
        ground=strip, depth=7.0, wavelength=4.0, height=0.6, asymmetry=asymmetry, spacing=0.03
    )
    across = np.arange(-48.0, 48.0, 0.01)
    z = bed.elevation_at(across, 0.3)
    assert (z.max(), z.min()) == pytest.approx((-6.7, -7.3), abs=0.002)
    assert z.mean() == pytest.approx(-7.0, abs=0.002)
    assert z.std() == pytest.approx(0.6 / np.sqrt(8.0), rel=0.005)
    power = np.abs(np.fft.rfft(z - z.mean()))
    assert np.fft.rfftfreq(len(z), 0.01)[power.argmax()] == pytest.approx(0.25, abs=0.002)
    rising = (np.diff(z) > 0).mean()  # towards the right of the axis, the gentle flank climbs
    assert rising / (1.0 - rising) == pytest.approx(asymmetry, rel=0.03)  # to a cell of a flank
    along = bed.elevation_at(1.3, np.arange(-1.4, 1.4, 0.2))
    assert np.ptp(along) < 1e-9


def test_crests_run_along_the_axis_and_the_steep_flank_falls_to_its_right() -> None:
    bed = ripples(
        ground=ground(axis=np.pi / 2), depth=7.0, wavelength=5.0, height=0.5, asymmetry=4.0,
        spacing=0.1,
    )  # fmt: skip
    assert np.ptp(bed.elevation_at(np.arange(-25.0, 25.0), 3.3)) < 1e-9
    to_the_south = bed.elevation_at(0.3, -np.arange(-40.0, 40.0, 0.05))
    steps = np.diff(to_the_south)
    assert steps.min() < -2.0 * steps.max()


def test_wandering_crests_stay_ripples_and_are_displaced_as_stated() -> None:
    straight = {"depth": 7.0, "wavelength": 4.0, "height": 0.6, "spacing": 0.25}
    bed = ripples(ground=ground(length=200.0), crest_wander=0.8, seed=2, **straight)
    z = bed.elevation_at(np.arange(-55.0, 55.0, 0.05)[:, None], np.arange(-95.0, 95.0, 2.0)[None])
    assert z.std() == pytest.approx(0.6 / np.sqrt(8.0), rel=0.02)
    phase = np.angle(np.exp(-0.5j * np.pi * np.arange(-55.0, 55.0, 0.05)) @ z)
    moved = np.unwrap(phase) / (2.0 * np.pi) * 4.0
    assert 0.4 < moved.std() < 1.6
    again = ripples(ground=ground(length=200.0), crest_wander=0.8, seed=2, **straight)
    np.testing.assert_array_equal(bed.mesh.vertices, again.mesh.vertices)


def test_ripples_that_cells_cannot_show_are_refused() -> None:
    with pytest.raises(ValueError, match=r"spacing 1 m must be at most 0\.25 m"):
        ripples(ground=ground(), depth=5.0, wavelength=4.0, height=0.5, asymmetry=3.0, spacing=1.0)
    with pytest.raises(ValueError, match="asymmetry at least 1"):
        ripples(ground=ground(), depth=5.0, wavelength=4.0, height=0.5, asymmetry=0.5, spacing=0.1)
    with pytest.raises(ValueError, match="more than 20,000,000"):
        ripples(ground=ground(length=1e5), depth=5.0, wavelength=1.0, height=0.1, spacing=0.1)


def test_a_reef_stands_where_it_is_stated_and_is_as_rough() -> None:
    relief = Roughness(rms=0.4, spectral_slope=3.2, longest_wavelength=12.0, seed=5)
    bed = reef(
        ground=ground(length=160.0, width=160.0),
        depth=9.0,
        top_depth=3.0,
        top_width=80.0,
        side_gradient=0.5,
        relief=relief,
        coral=CORAL,
        spacing=0.5,
    )
    x = np.arange(-36.0, 36.0, 0.5)[None, :]
    top = bed.elevation_at(x, np.arange(-72.0, 72.0, 0.5)[:, None])
    assert top.mean() == pytest.approx(-3.0, abs=0.05)
    assert top.std() == pytest.approx(0.4, rel=0.06)
    np.testing.assert_allclose(bed.elevation_at(np.array([-60.0, 60.0]), 5.0), -9.0, atol=1e-9)
    half_way = bed.elevation_at(np.array([46.0]), np.arange(-72.0, 72.0, 0.5)[:, None])
    assert half_way.mean() == pytest.approx(-6.0, abs=0.05)
    assert half_way.std() == pytest.approx(0.2, rel=0.15)
    assert fitted_slope(top, 0.5, (0.15, 0.7)) == pytest.approx(-3.2, abs=0.25)


def fitted_slope(z: np.ndarray, spacing: float, band: tuple[float, float]) -> float:
    """Return the slope of the power spectrum of a part of a field, its rim tapered."""
    taper = np.hanning(z.shape[0])[:, None] * np.hanning(z.shape[1])[None, :]
    power = np.abs(np.fft.fft2((z - z.mean()) * taper)) ** 2
    k = np.hypot(np.fft.fftfreq(z.shape[1], spacing), np.fft.fftfreq(z.shape[0], spacing)[:, None])
    edges = np.geomspace(*band, 13)
    middle = np.sqrt(edges[1:] * edges[:-1])
    mean = [power[(k >= a) & (k < b)].mean() for a, b in pairwise(edges)]
    return float(np.polyfit(np.log(middle), np.log(mean), 1)[0])


def test_a_reef_is_of_coral_and_the_sand_beside_it_is_not() -> None:
    relief = Roughness(rms=0.2, spectral_slope=3.0, longest_wavelength=10.0, seed=1)
    bed = reef(
        ground=ground(axis=0.7), depth=8.0, top_depth=4.0, top_width=20.0, side_gradient=1.0,
        relief=relief, coral=CORAL, spacing=0.5,
    )  # fmt: skip
    right = np.array([np.cos(0.7), -np.sin(0.7)])
    places = np.outer([0.0, 9.0, -12.0, 16.0, -20.0], right)
    _, face = cast_rays(
        bed.grid, np.column_stack([places, np.zeros(5)]), np.array([0.0, 0.0, -1.0])
    )
    assert bed.substrate[face].tolist() == [CORAL.code] * 3 + [0, 0]
    assert bed.reflectance[face].tolist() == [CORAL.reflectance] * 3 + [0.2, 0.2]
    with pytest.raises(ValueError, match="top_depth must be less"):
        reef(
            ground=ground(), depth=3.0, top_depth=4.0, top_width=20.0, side_gradient=1.0,
            relief=relief, coral=CORAL, spacing=1.0,
        )  # fmt: skip


def boulders(**changes: Any) -> BoulderField:
    keys: dict[str, Any] = {
        "length": 400.0,
        "width": 200.0,
        "density": 0.05,
        "least_diameter": 0.5,
        "mean_diameter": 1.2,
        "largest_diameter": 5.0,
        "burial": 0.25,
        "relief": 0.1,
        "seed": 3,
    }
    return BoulderField(**(keys | changes))


def test_boulders_are_poisson_and_their_diameters_exponential() -> None:
    """Against the law itself: 4000 boulders, Kolmogorov-Smirnov at 0.1 %; counts of 300 draws."""
    from scipy.stats import kstest, truncexpon

    places, diameters = boulders().draw()
    law = truncexpon(b=4.5 / 0.7, loc=0.5, scale=0.7)
    assert kstest(diameters, law.cdf).pvalue > 1e-3
    assert (diameters.min(), diameters.max()) == pytest.approx((0.5, 5.0), abs=0.8)
    for axis, extent in enumerate((400.0, 200.0)):
        assert kstest(places[:, axis] / extent + 0.5, "uniform").pvalue > 1e-3
    counts = np.array([len(boulders(density=0.001, seed=seed).draw()[1]) for seed in range(300)])
    assert counts.mean() == pytest.approx(80.0, abs=4.0 * np.sqrt(80.0 / 300))
    assert counts.var() == pytest.approx(80.0, rel=0.35)


def test_boulders_lie_on_the_bed_buried_as_stated() -> None:
    bed = slope(ground=ground(length=200.0), depth=8.0, gradient=0.1)
    field = boulders(length=30.0, width=50.0, density=0.02, relief=0.0)
    body = field.bodies(seabed=bed, east=10.0, north=-20.0, heading=np.pi / 2)
    rocks = body.split()
    places, diameters = field.draw()
    assert len(rocks) == len(places) > 15
    assert all(rock.is_watertight and rock.volume > 0.0 for rock in rocks)
    order = np.argsort([rock.centroid[0] for rock in rocks])
    for number, at in zip(np.argsort(places[:, 0]), order, strict=True):
        along, across = places[number]
        np.testing.assert_allclose(
            rocks[at].centroid[:2], [10.0 + along, -20.0 - across], atol=0.01
        )
        ground_there = float(bed.elevation_at(10.0 + along, -20.0 - across))
        lowest = rocks[at].bounds[0, 2]
        assert lowest == pytest.approx(ground_there - 0.25 * diameters[number], abs=0.03)
    with pytest.raises(ValueError, match="no seabed at"):
        field.bodies(seabed=bed, east=500.0, north=0.0)


def test_boulder_fields_that_cannot_be_are_refused() -> None:
    with pytest.raises(ValueError, match="ascend") as refused:
        boulders(mean_diameter=6.0, density=-1.0)
    assert len(str(refused.value).splitlines()) == 2
    with pytest.raises(ValueError, match="more than 20000"):
        boulders(density=5.0)
    with pytest.raises(ValueError, match="gave none"):
        boulders(density=1e-9).bodies(seabed=plane(ground=ground(), depth=5.0), east=0.0, north=0.0)


def clear_below(body: Any, x: float, y: float, bed: float) -> float:
    """Return the gap between the bed and the first thing above it."""
    t, _ = cast_rays(build_grid(body), np.array([x, y, bed - 5.0]), np.array([0.0, 0.0, 1.0]))
    return float(t[0]) - 5.0


def test_a_pipe_lies_on_the_bed_and_hangs_over_it_where_it_is_said_to() -> None:
    bed = plane(ground=ground(length=200.0), depth=6.0)
    route = np.array([[0.0, -90.0], [0.0, 90.0]])
    span = FreeSpan(start=80.0, length=20.0, gap=0.8)
    pipe = pipeline(seabed=bed, route=route, diameter=0.6, burial=0.1, spans=[span])
    assert pipe.is_watertight
    assert pipe.is_winding_consistent
    assert pipe.volume == pytest.approx(np.pi * 0.3**2 * 180.0, rel=0.03)
    gaps = [clear_below(pipe, 0.001, y, -6.0) for y in (-85.0, -9.0, 0.0, 9.0, 85.0)]
    assert gaps == pytest.approx([-0.1, 0.8, 0.8, 0.8, -0.1], abs=0.02)
    ramp = [clear_below(pipe, 0.001, y, -6.0) for y in np.arange(10.0, 31.0)]
    curvature = np.diff(ramp, 2)
    assert (np.diff(ramp) < 0.0)[:15].all()
    assert np.median(curvature[2:15]) == pytest.approx(1.0 / 200.0, rel=0.15)
    sideways, _ = cast_rays(
        build_grid(pipe),
        np.array([[-5.0, 0.0, -4.9], [-5.0, 0.0, -5.6]]),
        np.array([1.0, 0.0, 0.0]),
    )
    assert sideways[0] == pytest.approx(4.7, abs=0.01)
    assert np.isinf(sideways[1])


def test_a_stiff_pipe_bridges_hollows() -> None:
    relief = Roughness(rms=0.3, spectral_slope=2.5, longest_wavelength=15.0, seed=4)
    rough = plane(ground=ground(length=200.0, roughness=relief), depth=6.0, spacing=0.5)
    route = np.array([[-40.0, -80.0], [10.0, 0.0], [10.0, 90.0]])
    pipe = pipeline(seabed=rough, route=route, diameter=0.5, bend_radius=300.0)
    y = np.arange(5.0, 85.0, 0.5)
    bed = rough.elevation_at(10.0, y)
    gap = np.array([clear_below(pipe, 10.0, *at) for at in zip(y, bed, strict=True)])
    assert gap.min() > -0.2  # between stations, where the bed is finer than the pipe
    assert 0.1 < np.median(gap) < 2.0
    below = bed + gap
    assert np.diff(below, 2).max() / 0.5**2 < 1.5 / 300.0


def test_pipes_that_cannot_lie_are_refused() -> None:
    bed = plane(ground=ground(), depth=6.0)
    straight = np.array([[0.0, -20.0], [0.0, 20.0]])
    with pytest.raises(ValueError, match="no seabed at east 0"):
        pipeline(seabed=bed, route=5.0 * straight, diameter=0.5)
    with pytest.raises(ValueError, match="two different points"):
        pipeline(seabed=bed, route=straight[[0, 0]], diameter=0.5)
    spans = [FreeSpan(start=30.0, length=20.0, gap=1.0)]
    with pytest.raises(ValueError, match=r"from 30 to 50 m leaves the route, which is 40\.0 m"):
        pipeline(seabed=bed, route=straight, diameter=0.5, spans=spans)
