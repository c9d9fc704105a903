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
    """Root mean square of the swing."""
    period_s: Positive
    """Period of the spring."""
    damping: Damping = 0.3
    """Damping ratio of the spring."""


class DistanceSwing(Section):
    """Second-order noise: a spring of this period and damping, shaken."""

    rms_m: NotNegative
    """Root mean square of the swing."""
    period_s: Positive
    """Period of the spring."""
    damping: Damping = 0.3
    """Damping ratio of the spring."""


class Motion(Section):
    """How the aircraft moves about its line: trim, and sums of swings.

    Positive roll lowers the right wing, positive pitch lifts the nose, heading turns to the right.
    """

    roll_mean_deg: Trim = 0.0
    """Mean roll; positive lowers the right wing."""
    pitch_mean_deg: Trim = 0.0
    """Mean pitch; positive lifts the nose."""
    roll: list[AngleSwing] = Field(default_factory=list)
    """Swings of roll, added up."""
    pitch: list[AngleSwing] = Field(default_factory=list)
    """Swings of pitch, added up."""
    heading: list[AngleSwing] = Field(default_factory=list)
    """Swings of heading, added up."""
    cross_track: list[DistanceSwing] = Field(default_factory=list)
    """Swings to the side of the line, added up."""
    height: list[DistanceSwing] = Field(default_factory=list)
    """Swings of height, added up."""


class Navigation(Section):
    """What navigation gets wrong, measured less true, and how the sensor is mounted.

    Drifts are slow: first-order Gauss-Markov with an r.m.s. and a correlation time. Boresight and
    lever arm are known to georeferencing, their errors (true less believed) are not.
    `trajectory_files` are written beside ``trajectory.csv``, with the measured poses.
    """

    gnss_bias_east_m: float = 0.0
    """Constant error of the position, east."""
    gnss_bias_north_m: float = 0.0
    """Constant error of the position, north."""
    gnss_bias_up_m: float = 0.0
    """Constant error of the position, up."""
    gnss_drift_horizontal_m: NotNegative = 0.0
    """R.m.s. of the position's slow error, east and north each."""
    gnss_drift_up_m: NotNegative = 0.0
    """R.m.s. of the position's slow error, up."""
    gnss_drift_time_s: Positive = 600.0
    """Correlation time of the position's slow error."""
    gnss_white_horizontal_m: NotNegative = 0.0
    """R.m.s. of the position's error from flash to flash, east and north each."""
    gnss_white_up_m: NotNegative = 0.0
    """R.m.s. of the position's error from flash to flash, up."""
    ins_bias_roll_deg: Trim = 0.0
    """Constant error of roll."""
    ins_bias_pitch_deg: Trim = 0.0
    """Constant error of pitch."""
    ins_bias_heading_deg: Trim = 0.0
    """Constant error of heading."""
    ins_drift_roll_pitch_deg: NotNegative = 0.0
    """R.m.s. of the slow error of roll and pitch each."""
    ins_drift_heading_deg: NotNegative = 0.0
    """R.m.s. of the slow error of heading."""
    ins_drift_time_s: Positive = 600.0
    """Correlation time of the angles' slow errors."""
    ins_white_roll_pitch_deg: NotNegative = 0.0
    """R.m.s. of the error from flash to flash, roll and pitch each."""
    ins_white_heading_deg: NotNegative = 0.0
    """R.m.s. of the error from flash to flash, heading."""
    boresight_roll_deg: Trim = 0.0
    """Roll of the camera in the aircraft, known to georeferencing."""
    boresight_pitch_deg: Trim = 0.0
    """Pitch of the camera in the aircraft, known to georeferencing."""
    boresight_heading_deg: Annotated[float, Field(ge=-180.0, le=180.0)] = 0.0
    """Heading of the camera in the aircraft, known to georeferencing."""
    boresight_error_roll_deg: Trim = 0.0
    """Roll of the camera, true less believed."""
    boresight_error_pitch_deg: Trim = 0.0
    """Pitch of the camera, true less believed."""
    boresight_error_heading_deg: Trim = 0.0
    """Heading of the camera, true less believed."""
    lever_arm_forward_m: float = 0.0
    """Way from navigation's place to the camera, forward, known to georeferencing."""
    lever_arm_right_m: float = 0.0
    """The same, to the right."""
    lever_arm_down_m: float = 0.0
    """The same, down."""
    lever_arm_error_forward_m: float = 0.0
    """Lever arm forward, true less believed."""
    lever_arm_error_right_m: float = 0.0
    """Lever arm to the right, true less believed."""
    lever_arm_error_down_m: float = 0.0
    """Lever arm down, true less believed."""
    trajectory_files: list[Literal["cblue", "sbet"]] = Field(default_factory=list)
    """Formats in which the measured poses are written beside `trajectory.csv`."""
