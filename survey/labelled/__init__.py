"""Labelled waveforms: every pixel's light by origin, readings, thresholds and truth, for learning.

Frames are flown again from their addresses, so that any run has them.
"""
