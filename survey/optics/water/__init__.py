"""Water: the medium that the transport takes, and the ways to find its coefficients."""

from survey.optics.water.column import Layer, WaterColumn, profiled_water
from survey.optics.water.medium import PAPER_COEFFICIENTS, Water, petzold_water

__all__ = [
    "PAPER_COEFFICIENTS",
    "Layer",
    "Water",
    "WaterColumn",
    "petzold_water",
    "profiled_water",
]
