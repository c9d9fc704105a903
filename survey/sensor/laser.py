"""The laser of a flash lidar: one pulse lights the whole field of view."""

from __future__ import annotations

from dataclasses import dataclass

from scipy.constants import c, h


@dataclass(frozen=True, kw_only=True)
class Laser:
    """A pulsed laser whose light fills the camera's field of view evenly.

    Parameters
    ----------
    pulse_energy : float
        Energy of one pulse [J].
    wavelength : float
        Wavelength in vacuum [m].
    pulse_fwhm : float
        Full width at half maximum of the Gaussian pulse [s]; time zero is its centroid.

    Examples
    --------
    >>> laser = Laser(pulse_energy=1.0, wavelength=532e-9, pulse_fwhm=10e-9)
    >>> f"{laser.photons_per_pulse:.3e}"
    '2.678e+18'
    """

    pulse_energy: float
    wavelength: float
    pulse_fwhm: float

    @property
    def photon_energy(self) -> float:
        """Energy of one photon, h c / wavelength [J]."""
        return float(h * c / self.wavelength)

    @property
    def photons_per_pulse(self) -> float:
        """Photons in one pulse."""
        return self.pulse_energy / self.photon_energy

    @property
    def pulse_sigma(self) -> float:
        """Standard deviation of the Gaussian pulse [s]."""
        return self.pulse_fwhm / 2.3548200450309493
