"""One realisation of a sea: random waves of a spectrum, running by the laws of linear theory.

Wind waves stand on a square patch that repeats itself, made by a Fourier transform for every time
asked; swell is added wave by wave and repeats nowhere. Departures: the waves are independent and
Gaussian, crests as round as troughs; between its nodes the sheet has 0.4 % less slope variance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.fft import next_fast_len

from terrain.waves.dispersion import angular_frequency, wavenumber
from terrain.waves.energy import energy_of_bins, wavenumbers
from terrain.waves.lattice import WaveLattice, build_lattice
from terrain.waves.spectrum import WindSea
from terrain.waves.swell import PlaneWaves, Swell, mean_products

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

NODES_PER_WAVE = 4  # of the shortest


@dataclass(frozen=True, kw_only=True, eq=False)
class WaveField:
    """Waves that move with time; `WaveField.realised` makes them.

    Parameters
    ----------
    spacing : float
        Of the lattice's nodes [m].
    nodes : int
        Along a side of the patch after which the wind waves repeat themselves.
    bins : array (2, n)
        How often each wave fits into the patch towards north and east.
    coefficient : array (n,), complex
        Spline coefficients of the waves at time 0 [m].
    frequency : array (n,)
        [rad/s].
    swell : sequence of PlaneWaves
    wind_variance : float
        Expected mean square of the wind waves' elevation [m2].
    wind_slope_covariance : array (2, 2)
        Expected mean products of their slopes towards east and north [1].
    """

    spacing: float
    nodes: int
    bins: NDArray[np.int64]
    coefficient: ComplexArray
    frequency: FloatArray
    swell: Sequence[PlaneWaves]
    wind_variance: float
    wind_slope_covariance: FloatArray

    @classmethod
    def realised(
        cls,
        *,
        wind_sea: WindSea | None,
        wind_from: float = 0.0,
        swell: Sequence[Swell] = (),
        depth: float = np.inf,
        shortest: float = 2.0,
        patch: float = 512.0,
        chance: np.random.Generator,
    ) -> WaveField:
        """Return a realisation: the same generator and sea give the same waves.

        Parameters
        ----------
        wind_sea : WindSea or None
            Spectrum of the wind waves.
        wind_from : float
            Where the wind comes from, clockwise from grid north [rad].
        swell : sequence of Swell
        depth : float
            Of the water; deep without one [m].
        shortest : float
            Wavelength from which on waves are resolved [m]. By default that of a pixel's side,
            over which such a wave has no mean.
        patch : float
            Side of the square after which the wind waves repeat themselves [m].
        chance : Generator
            Of random numbers.

        Raises
        ------
        ValueError
            When the waves at the spectrum's peak do not fit into the patch twice.

        Examples
        --------
        >>> waves = WaveField.realised(
        ...     wind_sea=WindSea.fully_developed(wind_speed=5.0), patch=128.0,
        ...     chance=np.random.default_rng(1))
        >>> round(waves.significant_height, 2)
        0.61
        """
        nodes = 2 * next_fast_len(ceil(0.5 * NODES_PER_WAVE * patch / shortest))
        spacing, width = patch / nodes, 2.0 * pi / patch
        kx = ky = energy = np.empty(0)
        if wind_sea is not None:
            require_room(wind_sea, depth=depth, patch=patch)
            kx, ky = wavenumbers(width=width, largest=2.0 * pi / shortest)
            energy = energy_of_bins(
                kx, ky, width, sea=wind_sea, towards=wind_from + pi, depth=depth
            )
        draws = chance.standard_normal((2, energy.size))
        response = spline_response(kx * spacing) * spline_response(ky * spacing)
        waves = (draws[0] + 1j * draws[1]) * np.sqrt(energy) / response
        return cls(
            spacing=spacing,
            nodes=nodes,
            bins=np.rint(np.stack([ky, kx]) / width).astype(np.int64),
            coefficient=waves,
            frequency=angular_frequency(np.hypot(kx, ky), depth=depth),
            swell=[one.plane_waves(chance, depth=depth) for one in swell],
            wind_variance=float(energy.sum()),
            wind_slope_covariance=mean_products(kx, ky, energy),
        )

    @property
    def significant_height(self) -> float:
        """Four expected standard deviations of the elevation, swell included [m]."""
        return 4.0 * sqrt(self.wind_variance + sum(one.variance() for one in self.swell))

    @property
    def slope_covariance(self) -> FloatArray:
        """Expected mean products (2, 2) of all slopes towards east and north [1]."""
        covariance = self.wind_slope_covariance.copy()
        for one in self.swell:
            covariance += one.slope_covariance()
        return covariance

    def lattice(
        self, *, time: float, level: float, west: float, east: float, south: float, north: float
    ) -> WaveLattice:
        """Return the surface over a box at a time.

        Parameters
        ----------
        time : float
            [s].
        level : float
            Mean elevation [m].
        west, east, south, north : float
            Sides of the box in the local frame [m].
        """
        columns = _nodes_over(west, east, self.spacing)
        rows = _nodes_over(south, north, self.spacing)
        patch = self._wind_waves(time)
        coefficients = level + patch[np.ix_(rows % self.nodes, columns % self.nodes)]
        for one in self.swell:
            _add_swell(coefficients, one, time, columns, rows, self.spacing)
        return build_lattice(
            x0=float(columns[0] * self.spacing),
            y0=float(rows[0] * self.spacing),
            spacing=self.spacing,
            level=level,
            coefficients=coefficients,
        )

    def _wind_waves(self, time: float) -> FloatArray:
        """Return the spline coefficients (nodes, nodes) of the patch [m]."""
        turned = 0.5 * self.coefficient * np.exp(-1j * self.frequency * time)
        row, column = self.bins
        east, west = column >= 0, column <= 0
        waves = np.zeros((self.nodes, self.nodes // 2 + 1), np.complex128)
        waves[row[east], column[east]] += turned[east]
        waves[-row[west], -column[west]] += turned[west].conj()
        return np.fft.irfft2(waves, s=(self.nodes, self.nodes), norm="forward")


def require_room(sea: WindSea, *, depth: float, patch: float) -> None:
    """Refuse a patch in which the waves at the spectrum's peak have no room (ValueError).

    Of a fully developed sea less than 1 % is longer than twice its peak.
    """
    longest = 2.0 * pi / wavenumber(1.0 / sea.peak_frequency, depth=depth)
    if 2.0 * longest > patch:
        raise ValueError(
            f"waves: waves of {longest:.0f} m at the peak do not fit twice into the patch of "
            f"{patch:g} m. enlarge the patch"
        )


def spline_response(phase: FloatArray) -> FloatArray:
    """Return the values at the nodes over the coefficients, quadratic B-spline, by phase a node."""
    return np.asarray(0.75 + 0.25 * np.cos(phase))


def _nodes_over(low: float, high: float, spacing: float) -> NDArray[np.int64]:
    return np.arange(int(np.floor(low / spacing)) - 1, int(np.ceil(high / spacing)) + 2)


def _add_swell(
    coefficients: FloatArray,
    waves: PlaneWaves,
    time: float,
    columns: NDArray[np.int64],
    rows: NDArray[np.int64],
    spacing: float,
) -> None:
    response = spline_response(waves.kx * spacing) * spline_response(waves.ky * spacing)
    along = np.exp(1j * np.multiply.outer(rows * spacing, waves.ky))
    along *= waves.amplitude / response * np.exp(1j * (waves.phase - waves.frequency * time))
    across = np.exp(1j * np.multiply.outer(waves.kx, columns * spacing))
    # Not by a product of matrices, whose rounding may depend on the number of threads.
    coefficients += np.einsum("yn,nx->yx", along.real, across.real)
    coefficients -= np.einsum("yn,nx->yx", along.imag, across.imag)
