"""The sections [motion] and [navigation]: what disturbs a flight, and what is known of it."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from survey.scenario.sections import NotNegative, Positive, Section

Trim = Annotated[float, Field(ge=-30.0, le=30.0)]
Damping = Annotated[float, Field(ge=0.01, le=10.0)]


class AngleSwing(Section):
    """Second-order noise: a spring of this period and damping, shaken."""

    rms_deg: NotNegative
    period_s: Positive
    damping: Damping = 0.3


class DistanceSwing(Section):
    """Second-order noise: a spring of this period and damping, shaken."""

    rms_m: NotNegative
    period_s: Positive
    damping: Damping = 0.3


class Motion(Section):
    """How the aircraft moves about its line: trim, and sums of swings.

    Positive roll lowers the right wing, positive pitch lifts the nose, heading turns to the right.
    """

    roll_mean_deg: Trim = 0.0
    pitch_mean_deg: Trim = 0.0
    roll: list[AngleSwing] = Field(default_factory=list)
    pitch: list[AngleSwing] = Field(default_factory=list)
    heading: list[AngleSwing] = Field(default_factory=list)
    cross_track: list[DistanceSwing] = Field(default_factory=list)
    height: list[DistanceSwing] = Field(default_factory=list)


class Navigation(Section):
    """What navigation gets wrong, measured less true, and how the sensor is mounted.

    Drifts are slow: first-order Gauss-Markov with an r.m.s. and a correlation time. Boresight and
    lever arm are known to georeferencing, their errors (true less believed) are not.
    `trajectory_files` are written beside ``trajectory.csv``, with the measured poses.
    """

    gnss_bias_east_m: float = 0.0
    gnss_bias_north_m: float = 0.0
    gnss_bias_up_m: float = 0.0
    gnss_drift_horizontal_m: NotNegative = 0.0
    gnss_drift_up_m: NotNegative = 0.0
    gnss_drift_time_s: Positive = 600.0
    gnss_white_horizontal_m: NotNegative = 0.0
    gnss_white_up_m: NotNegative = 0.0
    ins_bias_roll_deg: Trim = 0.0
    ins_bias_pitch_deg: Trim = 0.0
    ins_bias_heading_deg: Trim = 0.0
    ins_drift_roll_pitch_deg: NotNegative = 0.0
    ins_drift_heading_deg: NotNegative = 0.0
    ins_drift_time_s: Positive = 600.0
    ins_white_roll_pitch_deg: NotNegative = 0.0
    ins_white_heading_deg: NotNegative = 0.0
    boresight_roll_deg: Trim = 0.0
    boresight_pitch_deg: Trim = 0.0
    boresight_heading_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 0.0
    boresight_error_roll_deg: Trim = 0.0
    boresight_error_pitch_deg: Trim = 0.0
    boresight_error_heading_deg: Trim = 0.0
    lever_arm_forward_m: float = 0.0
    lever_arm_right_m: float = 0.0
    lever_arm_down_m: float = 0.0
    lever_arm_error_forward_m: float = 0.0
    lever_arm_error_right_m: float = 0.0
    lever_arm_error_down_m: float = 0.0
    trajectory_files: list[Literal["cblue", "sbet"]] = Field(default_factory=list)
