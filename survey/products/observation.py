"""All that one flash gave, before most of it is forgotten."""

from __future__ import annotations

from dataclasses import dataclass

from survey.cloud.echo import Echo
from survey.cloud.noise import NoiseModel
from survey.cloud.truth import TrueTargets
from survey.flight.pose import Frame
from survey.products.frame_file import FrameResult
from survey.sensor.detector import Readings
from survey.transport.waveforms import Waveforms


@dataclass(frozen=True, kw_only=True)
class Observation:
    """A flash with its light, its readings, what was made of them, and the truth.

    Parameters
    ----------
    frame : Frame
    waveforms : Waveforms
        Expected photo-electrons of one pulse.
    readings : Readings
        Of the detector.
    noise : NoiseModel
        At the measured pose, without the doubt of the flash.
    first, bottom : Echo
        First echoes, and bottom echoes.
    targets : TrueTargets
        Where the pixels truly look.
    result : FrameResult
        What a run keeps.
    """

    frame: Frame
    waveforms: Waveforms
    readings: Readings
    noise: NoiseModel
    first: Echo
    bottom: Echo
    targets: TrueTargets
    result: FrameResult
