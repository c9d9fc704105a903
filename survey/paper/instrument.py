"""The numbers that [Lisenko2017] prints, and what it leaves out, assumed."""

from __future__ import annotations

from survey.sensor.laser import Laser

LASER = Laser(pulse_energy=1.0, wavelength=532e-9, pulse_fwhm=10e-9)
MEASURING_TIME = 10e-9  # tau_g of equation (10) [s]
HEIGHT = 200.0  # [m]
PIXELS_LONG, PIXELS_SHORT = 64, 32
PIXELS = PIXELS_LONG * PIXELS_SHORT
PIXEL_ANGLE = 8e-3  # 2 F_r [rad]: 2 m at 250 m
PIXEL_SOLID_ANGLE = PIXEL_ANGLE**2  # of a square pixel [sr]; equation (1) has a round one
INDEX = 1.33  # m, for refraction and for time alike [1]
BOTTOM_DEPTH = 50.0  # [m]
BOTTOM_REFLECTANCE = 0.1  # rho, Lambertian [1]
WATERS = {"P02": "clear", "P05": "coastal", "P07": "harbor"}
REQUIRED_SNR = 10.0  # a ratio of powers [1]
SUNS = {"night": 1e-3, "day": 50.0}  # L_b [W/(m2 um sr)]
BRIGHTNESSES = (1e-3, 1e-2, 1e-1, 1.0, 10.0, 50.0)  # L_b [W/(m2 um sr)]; the inner four are ours
PER_MICROMETRE = 1e6  # from W/(m2 um sr) to W/(m3 sr)
PUBLISHED = {
    "day": {"P02": 32.0, "P05": 17.0, "P07": 8.0},
    "night": {"P02": 44.0, "P05": 24.0, "P07": 12.0},
}
"""Depths down to which the signal-to-noise ratio exceeds 10 [m]."""

# Not printed, hence assumed.
EFFICIENCY = 0.3  # photo-electrons per photon at the aperture, losses of the optics included [1]
INTERNAL_NOISE = 0.0  # n_n [1/s]; a SPAD's 1e4 would be 1e-4 counts in the measuring time
WIND_SPEED = 5.0  # for the spike of the surface [m/s]; the paper's wind by day
