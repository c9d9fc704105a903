"""Waves on the sea: spectra, one realisation that moves with time, and rays that meet it."""

from terrain.waves.field import WaveField
from terrain.waves.lattice import WaveLattice, elevation_and_slopes, meets_surface
from terrain.waves.spectrum import WindSea
from terrain.waves.swell import Swell

__all__ = [
    "Swell",
    "WaveField",
    "WaveLattice",
    "WindSea",
    "elevation_and_slopes",
    "meets_surface",
]
