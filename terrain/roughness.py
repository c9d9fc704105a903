"""Synthetic fine relief with a power-law spectrum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Roughness:
    """Isotropic Gaussian relief whose power falls with a power of the wavenumber.

    Parameters
    ----------
    rms : float
        Root mean square elevation of the realised field about its mean of zero [m].
    spectral_slope : float
        g of the two-dimensional power spectral density k^-g; a profile falls as k^-(g - 1). Seabeds
        have 2 to 4 (Jackson and Richardson, High-Frequency Seafloor Acoustics, 2007, chapter 6).
    longest_wavelength : float
        Wavelength beyond which there is no relief [m].
    seed : int
        Same seed and lattice, same relief.

    Raises
    ------
    ValueError
        When the r.m.s. is negative or the wavelength or the slope is not positive.

    Examples
    --------
    >>> ripples = Roughness(rms=0.1, spectral_slope=3.0, longest_wavelength=10.0, seed=1)
    >>> float(ripples.field((64, 32), spacing=0.5).std().round(6))
    0.1
    """

    rms: float
    spectral_slope: float
    longest_wavelength: float
    seed: int

    def __post_init__(self) -> None:
        positive = {
            "spectral_slope": self.spectral_slope,
            "longest_wavelength": self.longest_wavelength,
        }
        faults = [f"roughness: {k}: {v} is not positive" for k, v in positive.items() if not v > 0]
        if not self.rms >= 0.0:
            faults.append(f"roughness: rms: {self.rms} is negative")
        if faults:
            raise ValueError("\n".join(faults))

    def field(self, shape: tuple[int, int], *, spacing: float) -> FloatArray:
        """Return elevations (rows, cols) [m] about zero on a lattice of ``spacing`` [m].

        Raises ValueError when the lattice resolves no wavelength of the relief.
        """
        kx = np.fft.fftfreq(shape[1], spacing)
        ky = np.fft.fftfreq(shape[0], spacing)
        k = np.hypot(kx, ky[:, None])
        present = k >= 1.0 / self.longest_wavelength
        if not present.any():
            raise ValueError(
                f"roughness: longest_wavelength: {self.longest_wavelength} m is not resolved at "
                f"{spacing} m. give a finer spacing"
            )
        amplitude = np.zeros(shape)
        amplitude[present] = k[present] ** (-0.5 * self.spectral_slope)
        noise = np.random.Generator(np.random.Philox(key=self.seed)).standard_normal(shape)
        relief = np.fft.ifft2(np.fft.fft2(noise) * amplitude).real
        relief *= self.rms / relief.std()
        return np.asarray(relief)

    def sentence(self) -> str:
        """Return what a product says of the relief."""
        return (
            f"Synthetic roughness of {self.rms:g} m r.m.s. added, spectral slope "
            f"{self.spectral_slope:g}, wavelengths up to {self.longest_wavelength:g} m, "
            f"seed {self.seed}."
        )
