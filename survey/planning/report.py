"""What `bathyflash plan` says: as plain values for JSON, as text, as warnings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from survey.planning.eye_safety import BINOCULARS, SOURCE
from survey.planning.gaps import Gap
from survey.planning.overlap import Overlap
from survey.planning.plan import Coverage, SurveyPlan
from survey.planning.run_costs import machine

DECIMALS = 3


def as_json(plan: SurveyPlan) -> dict[str, Any]:
    """Return a plan as plain values, units in the keys; None where there is nothing to say.

    Overlaps are medians, ``least`` the worst pair; below 0 they are gaps. Polygons of gaps are
    rings of easting and northing on the scenario's map, the outer one first.
    """
    depths = dict(zip(("least", "median", "greatest"), map(_number, plan.depth), strict=True))
    grounds = {
        "surface": (plan.surface, 0.0),
        "bottom": (plan.bottom, depths["median"]),
        "bottom_in_air": (plan.bottom_in_air, depths["median"]),
    }
    expected, eye = plan.expectation, plan.eye
    return {
        "title": plan.title,
        "crs_epsg": plan.map_frame.epsg,
        "frames": len(plan.frames),
        "lines": plan.lines,
        "height_m": _number(plan.height),
        "flight_time_s": _number(plan.flight_seconds),
        "flight_length_m": _number(plan.flight_length),
        "seabed_depth_m": depths,
        "wave_height_left_out_m": _number(plan.wave_height),
        "overlap": {
            name: {"depth_m": depth, **_overlaps(cover)} for name, (cover, depth) in grounds.items()
        },
        "gaps": {name: _gaps(cover, plan) for name, (cover, _) in grounds.items()},
        "density_per_m2": _number(plan.density),
        "density_of_a_frame_per_m2": _number(plan.frame_density),
        "depth_limit_m": {
            "day": _number(expected.day.depth),
            "night": _number(expected.night.depth),
            "run_day": _number(expected.run_day.depth),
            "run_night": _number(expected.run_night.depth),
            "gate": _number(expected.day.gate_depth),
        },
        "depth_limit_basis": expected.basis,
        "depth_limit_is_estimate": expected.is_estimate,
        "bottom_reflectance": _number(expected.reflectance),
        "output_mb": _number(plan.output_bytes / 1e6),
        "run_time_s": _number(plan.run_seconds),
        "run_workers": plan.workers,
        "run_costs_measured_on": machine(),
        "laser_hazard": {
            "nohd_m": _number(eye.distance),
            "nohd_binoculars_m": _number(eye.binocular_distance),
            "limit_j_per_m2": float(f"{eye.limit:.4g}"),
            "at_water_j_per_m2": float(f"{eye.at_water:.4g}"),
            "pulses_while_passing": eye.pulses,
            "is_safe_at_water": eye.distance < plan.height,
            "is_safe_at_water_through_binoculars": eye.binocular_distance < plan.height,
            "source": SOURCE,
        },
        "warnings": list(warnings(plan)),
    }


def _number(value: float) -> float | None:
    return round(float(value), DECIMALS) if np.isfinite(value) else None


def _overlaps(cover: Coverage) -> dict[str, float | None]:
    found: dict[str, float | None] = {}
    for name, overlap in (("forward", cover.forward), ("side", cover.side)):
        found |= {
            f"{name}_m": None if overlap is None else _number(overlap.length),
            f"{name}_percent": None if overlap is None else _number(100.0 * overlap.share),
            f"{name}_least_m": None if overlap is None else _number(overlap.least_length),
        }
    return found


def _gaps(cover: Coverage, plan: SurveyPlan) -> dict[str, Any]:
    return {
        "count": len(cover.swath.gaps),
        "area_m2": _number(cover.swath.gap_area),
        "forward_m": _number(gap_length(cover.forward)),
        "side_m": _number(gap_length(cover.side)),
        "polygons": [_polygon(gap, plan) for gap in cover.swath.gaps],
    }


def _polygon(gap: Gap, plan: SurveyPlan) -> dict[str, Any]:
    origin = plan.map_frame.origin[:2]
    rings = [(ring + origin).round(DECIMALS).tolist() for ring in gap.rings]
    return {"area_m2": _number(gap.area), "coordinates": rings}


def gap_length(overlap: Overlap | None) -> float:
    """Return the widest gap between neighbours, 0 where they all overlap [m]."""
    return 0.0 if overlap is None else max(-overlap.least_length, 0.0)


def warnings(plan: SurveyPlan) -> Iterator[str]:
    """Yield a line for all that spoils a survey and shows before it is flown."""
    for name, cover in (("at the water surface", plan.surface), ("on the seabed", plan.bottom)):
        if cover.swath.gaps:
            yield f"gaps {name}: {len(cover.swath.gaps)}, {cover.swath.gap_area:,.0f} m2" + _widths(
                cover
            )
    yield from _depth_warnings(plan)
    if plan.eye.distance >= plan.height:
        yield (
            f"the laser is a hazard to eyes at the water: {plan.eye.distance:.0f} m below the "
            f"aircraft at least, it flies at {plan.height:.0f} m"
        )
    if plan.seabed_fault is not None:
        yield f"a run would refuse this flight: {plan.seabed_fault}"


def _widths(cover: Coverage) -> str:
    widths = [
        f"{gap_length(overlap):.1f} m {words}"
        for overlap, words in ((cover.forward, "along the lines"), (cover.side, "between lines"))
        if gap_length(overlap) > 0.0
    ]
    return f" ({', '.join(widths)} at most)" if widths else ""


def _depth_warnings(plan: SurveyPlan) -> Iterator[str]:
    day, (_, median, deepest) = plan.expectation.day, plan.depth
    if deepest > day.depth:
        how = "all but" if median > day.depth else "partly"
        yield (
            f"the seabed, down to {deepest:.1f} m, is {how} deeper than the limit by day, "
            f"{day.depth:.1f} m"
        )
    if deepest > day.gate_depth:
        yield (
            f"the receiver's gate ends at a depth of {day.gate_depth:.1f} m, the seabed goes down "
            f"to {deepest:.1f} m: take more bins"
        )


def as_text(plan: SurveyPlan) -> str:
    """Return a plan as lines for people."""
    expected, eye = plan.expectation, plan.eye
    shallow, median, deep = plan.depth
    limited = " (the gate ends there)" if expected.day.is_set_by_the_gate else ""
    return "\n".join(
        (
            f"{plan.title}: {len(plan.frames)} frames, lines: {plan.lines}, "
            f"{plan.flight_length / 1000.0:.1f} km, {plan.flight_seconds:.0f} s, "
            f"{plan.height:.0f} m above the water",
            "",
            _row("", "water surface", "seabed", "seabed, straight rays"),
            _row("depth", "0 m", *2 * (_depth_words(shallow, median, deep),)),
            *(
                _row(words, *(_words(getattr(cover, name)) for cover in _grounds(plan)))
                for words, name in (("forward overlap", "forward"), ("sidelap", "side"))
            ),
            _row("gaps", *(_gap_words(cover) for cover in _grounds(plan))),
            "",
            *_sea_words(plan),
            f"density       {plan.density:.2f} points/m2 of the seabed if every pixel finds it, "
            f"{plan.frame_density:.2f} in one frame",
            f"depth limit   day {expected.day.depth:.1f} m, night {expected.night.depth:.1f} m"
            f"{limited}",
            f"              a run with these walks shows {expected.run_day.depth:.1f} and "
            f"{expected.run_night.depth:.1f} m",
            f"              {expected.basis}; reflectance {expected.reflectance:.2g}",
            f"run           {plan.output_bytes / 1e6:.0f} MB, {_duration(plan.run_seconds)} with "
            f"{plan.workers} workers (figures measured on {machine()})",
            f"laser hazard  to {eye.distance:.0f} m below the aircraft, through binoculars "
            f"{BINOCULARS} to {eye.binocular_distance:.0f} m",
            f"              at the water {eye.at_water:.2g} J/m2 a pulse, {eye.limit:.2g} allowed",
            f"              {_eye_words(plan)}",
            f"              by {SOURCE}",
        )
    )


def _sea_words(plan: SurveyPlan) -> Iterator[str]:
    if plan.wave_height > 0.0:
        yield (
            f"sea           taken as level: waves of {plan.wave_height:.1f} m (significant) bend "
            "what a run sees, and take it longer"
        )


def _eye_words(plan: SurveyPlan) -> str:
    if plan.eye.distance >= plan.height:
        return "not safe to look up"
    behind = "not" if plan.eye.binocular_distance >= plan.height else "and also"
    return f"safe to the naked eye, {behind} through binoculars"


def _grounds(plan: SurveyPlan) -> tuple[Coverage, Coverage, Coverage]:
    return plan.surface, plan.bottom, plan.bottom_in_air


def _row(*cells: str) -> str:
    first, *others = cells
    return f"{first:16}" + "".join(f"{cell:>29}" for cell in others)


def _depth_words(shallow: float, median: float, deep: float) -> str:
    if not np.isfinite(median):
        return "dry"
    return f"{median:.1f} m" if deep - shallow < 0.1 else f"{shallow:.1f} to {deep:.1f} m"


def _words(overlap: Overlap | None) -> str:
    if overlap is None:
        return "-"
    if overlap.length < 0.0:
        return f"none, gap {-overlap.length:.1f} m"
    least = overlap.least_length
    worst = f", least {least:.1f}" if overlap.length - least > 0.05 else ""
    return f"{overlap.length:.1f} m{worst} ({100.0 * overlap.share:.1f} %)"


def _gap_words(cover: Coverage) -> str:
    count = len(cover.swath.gaps)
    return f"{count}, {cover.swath.gap_area:,.0f} m2" if count else "none"


def _duration(seconds: float) -> str:
    """Return seconds in the unit that fits.

    Examples
    --------
    >>> _duration(42.0), _duration(600.0), _duration(9000.0)
    ('42 s', '10 min', '2.5 h')
    """
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.1f} h"
