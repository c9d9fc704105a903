"""A realisation against the integrals of its spectrum, and how it moves."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.constants import g
from scipy.integrate import quad

from terrain.sea_surface import SeaSurface
from terrain.waves import Swell, WaveField, WindSea, elevation_and_slopes
from terrain.waves.dispersion import angular_frequency, group_speed
from terrain.waves.energy import spectrum_of_wavenumber

FloatArray = NDArray[np.float64]

PATCH = 256.0
SHORTEST = 2.0
SEAS = {
    "full": WindSea.fully_developed(wind_speed=6.0),
    "growing": WindSea.fetch_limited(wind_speed=10.0, fetch=20e3),
}


def field_of(sea: WindSea | None, *, seed: int = 1, **options: object) -> WaveField:
    return WaveField.realised(
        wind_sea=sea,
        chance=np.random.default_rng(seed),
        **{"patch": PATCH, "shortest": SHORTEST, "wind_from": 0.3, **options},
    )


def over(
    field: WaveField, *, time: float = 0.0, side: float = PATCH, step: float = 0.5
) -> FloatArray:
    """Return elevation and slopes (3, n, n) over a square."""
    waves = field.lattice(time=time, level=0.0, west=0.0, east=side, south=0.0, north=side)
    at = np.arange(0.0, side - 1e-9, step) + 0.15
    rows = [[elevation_and_slopes(waves, x, y) for x in at] for y in at]
    return np.moveaxis(np.array(rows), -1, 0)


def integral(sea: WindSea, power: int) -> float:
    """Return the integral of k^power E(f) over the frequencies of the resolved waves."""
    longest, shortest = np.sqrt(g * 2.0 * np.pi / np.array([PATCH, SHORTEST])) / (2.0 * np.pi)

    def weighted(frequency: float) -> float:
        k = (2.0 * np.pi * frequency) ** 2 / g
        return float(sea.density(np.array([frequency]))[0] * k**power)

    peak = sea.peak_frequency
    parts = [(longest, peak), (peak, 1.5 * peak), (1.5 * peak, shortest)]
    return float(sum(quad(weighted, low, high)[0] for low, high in parts))


@cache
def realisations(name: str) -> FloatArray:
    """Return mean squares of elevation and slope in 64 patches (64, 2), over their expectation."""
    ratios = []
    for seed in range(64):
        field = field_of(SEAS[name], seed=seed, patch=128.0)
        z, slope_x, slope_y = over(field, side=128.0, step=3.1)
        total = np.trace(field.wind_slope_covariance)
        slopes = (slope_x**2).mean() + (slope_y**2).mean()
        ratios.append([(z**2).mean() / field.wind_variance, slopes / total])
    return np.array(ratios)


@pytest.mark.parametrize("name", SEAS)
def test_expectations_are_the_integrals_of_the_spectrum(name: str) -> None:
    field, sea = field_of(SEAS[name]), SEAS[name]
    assert field.wind_variance == pytest.approx(integral(sea, 0), rel=3e-3)
    assert np.trace(field.wind_slope_covariance) == pytest.approx(integral(sea, 2), rel=3e-3)


@pytest.mark.parametrize("name", SEAS)
def test_realised_height_and_slopes(name: str) -> None:
    """Means over 64 patches of 128 m, errors below 2 % of the variance and 0.7 % of the slopes'.

    The sheet has 0.4 % less slope variance than its waves, of which the shortest have four nodes.
    """
    ratios = realisations(name)
    error = ratios.std(axis=0, ddof=1) / np.sqrt(len(ratios))
    assert np.all(error < [0.02, 0.007])
    assert abs(ratios[:, 0].mean() - 1.0) < 3.0 * error[0]
    assert abs(ratios[:, 1].mean() - 0.996) < 3.0 * error[1]


def test_sampling_error_is_that_of_gaussian_waves() -> None:
    """The variance over a patch scatters by the square root of the sum of squared energies."""
    sea, patch = SEAS["growing"], 128.0
    width = 2.0 * np.pi / patch
    k = np.arange(-40.0, 41.0) * width
    kx, ky = np.meshgrid(k, k)
    kx[40, 40] = 1e-9
    energy = width**2 * spectrum_of_wavenumber(kx, ky, sea=sea, towards=0.3, depth=np.inf)
    both_ways = 0.5 * (energy + energy[::-1, ::-1])
    expected = np.sqrt(2.0 * (both_ways**2).sum()) / energy.sum()
    seen = np.std(realisations("growing")[:, 0], ddof=1)
    assert seen == pytest.approx(expected, rel=3.0 / np.sqrt(2.0 * 63))


def test_swell_runs_at_its_phase_speed() -> None:
    """8.3 m/s for 10 s and a little less in 8 m of water, to the north if it comes from the south.

    There waves of all periods are nearly as fast, so that their sum keeps its shape for a second.
    """
    swell = Swell(height=1.0, period=10.0, comes_from=np.pi)
    field = field_of(None, swell=[swell], depth=8.0)
    box = {"level": 0.0, "west": -9.0, "east": 9.0, "south": -99.0, "north": 499.0}
    before, later = (field.lattice(time=time, **box) for time in (5.0, 6.0))
    y, moves = np.arange(0.0, 480.0, 2.0), np.arange(-15.0, 15.0, 0.1)
    new = np.array([elevation_and_slopes(later, 0.0, at)[0] for at in y])
    old = [[elevation_and_slopes(before, 0.0, at - move)[0] for at in y] for move in moves]
    misfit = np.square(new - old).mean(axis=1)
    assert moves[np.argmin(misfit)] == pytest.approx(8.3, abs=0.25)
    assert misfit.min() < 0.01 * np.square(new).mean()


def test_long_waves_of_the_wind_run_at_their_phase_speed() -> None:
    """Fourier components of 17 to 64 m in wind from the west: c = sqrt(g / k), 1 % in the median.

    Each has a little of a wave that runs against the wind, and stands still by as much.
    """
    field = field_of(SEAS["growing"], wind_from=1.5 * np.pi)
    before, later = (np.fft.fft2(over(field, time=time, step=1.0)[0]) for time in (7.0, 8.0))
    k = 2.0 * np.pi * np.arange(4, 16) / PATCH
    turned = -np.angle(later[0, 4:16] / before[0, 4:16])
    assert np.median(np.abs(turned / k / np.sqrt(g / k) - 1.0)) < 0.01


def test_one_realisation_a_seed() -> None:
    """The same seed gives the same bytes in any order of times; another seed gives others."""
    box = {"level": 0.0, "west": -20.0, "east": 20.0, "south": -10.0, "north": 10.0}
    one, same, other = (field_of(SEAS["full"], seed=seed) for seed in (3, 3, 4))
    first = [one.lattice(time=time, **box).coefficients.tobytes() for time in (0.0, 5.0)]
    again = [same.lattice(time=time, **box).coefficients.tobytes() for time in (5.0, 0.0)]
    assert first == again[::-1]
    assert first[0] != first[1]
    assert other.lattice(time=0.0, **box).coefficients.tobytes() not in first


def test_boxes_of_one_time_are_parts_of_one_sea() -> None:
    field = field_of(SEAS["full"], swell=[Swell(height=0.5, period=8.0, comes_from=1.0)])
    near = field.lattice(time=2.0, level=1.0, west=-5.0, east=5.0, south=-5.0, north=5.0)
    wide = field.lattice(time=2.0, level=1.0, west=-60.0, east=70.0, south=-50.0, north=8.0)
    for x, y in np.random.default_rng(1).uniform(-5.0, 5.0, (50, 2)):
        assert elevation_and_slopes(near, x, y) == pytest.approx(
            elevation_and_slopes(wide, x, y), abs=1e-12
        )


def test_wind_waves_do_not_repeat_within_half_a_patch() -> None:
    """The correlation with itself, shifted by 20 to 128 m, stays that of chance."""
    z = over(field_of(SEAS["growing"]), step=1.0)[0]
    power = np.abs(np.fft.fft2(z - z.mean())) ** 2
    correlation = np.fft.ifft2(power).real / power.mean()
    shift = np.minimum(np.arange(256), 256 - np.arange(256))
    far = np.hypot(shift, shift[:, None]) > 20.0
    assert np.abs(correlation[far]).max() < 0.35


@pytest.mark.parametrize("wind_speed", [2.0, 5.0, 12.0])
@pytest.mark.parametrize("wind_from", [0.0, 2.0])
def test_remaining_and_resolved_slopes_are_cox_and_munks(
    wind_speed: float, wind_from: float
) -> None:
    """Along and across the wind apart, none negative; swell takes nothing from them."""
    waves = WaveField.realised(
        wind_sea=WindSea.fetch_limited(wind_speed=wind_speed, fetch=15e3),
        wind_from=wind_from,
        swell=[Swell(height=2.0, period=7.0, comes_from=wind_from)],
        patch=256.0,
        chance=np.random.default_rng(1),
    )
    sea = SeaSurface.from_wind(level=0.0, wind_speed=wind_speed, wind_from=wind_from, waves=waves)
    along, across = np.add(sea.remaining_slope_variance, sea.resolved_slope_variance)
    assert along == pytest.approx(3.16e-3 * wind_speed)
    assert across == pytest.approx(0.003 + 1.92e-3 * wind_speed)
    assert min(sea.remaining_slope_variance) > 0.0
    assert sea.resolved_slope_variance[0] > sea.resolved_slope_variance[1] > 0.0


def test_resolved_slopes_beyond_cox_and_munks_leave_none() -> None:
    """Old waves under a falling wind: the roughness is zero, not negative."""
    waves = field_of(WindSea.fully_developed(wind_speed=8.0))
    sea = SeaSurface.from_wind(level=0.0, wind_speed=0.5, wind_from=0.3, waves=waves)
    assert sea.remaining_slope_variance[0] == 0.0


def test_a_sea_in_shallow_water_is_lower() -> None:
    deep, shallow = field_of(SEAS["growing"]), field_of(SEAS["growing"], depth=2.0)
    assert shallow.significant_height < 0.9 * deep.significant_height
    assert shallow.frequency.min() < deep.frequency.min()


def test_spectrum_of_wavenumber_holds_the_energy_of_frequency() -> None:
    """Around all directions k E(k) dk is E(f) df."""
    sea, k = SEAS["growing"], np.array([0.5])
    angle = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
    kx, ky = k * np.sin(angle), k * np.cos(angle)
    mean = spectrum_of_wavenumber(kx, ky, sea=sea, towards=0.0, depth=np.inf).mean()
    frequency = angular_frequency(k) / (2.0 * np.pi)
    expected = sea.density(frequency) * group_speed(k) / (2.0 * np.pi)
    assert mean * 2.0 * np.pi * k == pytest.approx(expected, rel=1e-6)


def test_waves_longer_than_the_patch_are_refused() -> None:
    with pytest.raises(ValueError, match="waves of 96 m at the peak do not fit twice"):
        field_of(WindSea.fully_developed(wind_speed=10.0), patch=150.0)
