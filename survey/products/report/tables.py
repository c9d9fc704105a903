"""What a mission found, in tables and sentences of HTML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

ROWS = (
    ("frames", "{:.0f}", "frames flown"),
    ("points_bottom", "{:.0f}", "bottom points (classes 40 and 43)"),
    ("points_surface", "{:.0f}", "sea surface points"),
    ("points_ground", "{:.0f}", "dry ground points"),
    ("bias_m", "{:+.3f} m", "mean error of the bottom, measured less true elevation"),
    ("rmse_m", "{:.3f} m", "root mean square error of the bottom"),
    ("p95_abs_error_m", "{:.3f} m", "95 % of the bottom points err by less"),
    ("surface_bias_m", "{:+.3f} m", "mean error of the sea surface"),
    ("ground_bias_m", "{:+.3f} m", "mean error of dry ground"),
    ("false_bottoms", "{:.0f}", "bottom points more than 1 m off"),
    ("coverage_fraction", "{:.1%}", "of the wet survey area holds a bottom point"),
    ("density_per_m2", "{:.2f} /m<sup>2</sup>", "bottom points on the wet survey area"),
    ("detection_depth_m", "{:.1f} m", "depth to which detection is 90 % likely, of depths flown"),
    (
        "found_fraction_above_detection_depth",
        "{:.1%}",
        "of the pixels over water no deeper than that found the bottom",
    ),
    ("monte_carlo_relative_error", "{:.1%}", "Monte Carlo error of a pixel's echo, median"),
)
SUBSTRATE_COLUMNS = {
    "pixels_wet": "wet pixels",
    "found_fraction": "share found",
    "points_bottom": "bottom points",
    "bias_m": "mean error [m]",
    "rmse_m": "r.m.s. error [m]",
}
OVERLAP_COLUMNS = {
    "area_m2": "area [m<sup>2</sup>]",
    "cells": "cells",
    "mean_difference_m": "mean [m]",
    "rms_difference_m": "r.m.s. [m]",
    "p95_abs_difference_m": "95 % within [m]",
}


def key_figures(metrics: Mapping[str, Any]) -> str:
    """Return what was measured, a line each."""
    rows = (
        f"<tr><td>{form.format(metrics[name])}</td><td>{words}</td></tr>"
        for name, form, words in ROWS
        if metrics.get(name) is not None
    )
    return "<table>\n" + "\n".join(rows) + "\n</table>"


def compared_figures(runs: Mapping[str, Mapping[str, Any]]) -> str:
    """Return what was measured in several runs, by their names, a column each."""
    head = "".join(f"<td>{escape(name)}</td>" for name in runs)
    rows = [f"<tr><td></td>{head}</tr>"]
    for name, form, words in ROWS:
        values = [metrics.get(name) for metrics in runs.values()]
        cells = "".join(f"<td>{'' if v is None else form.format(v)}</td>" for v in values)
        if any(value is not None for value in values):
            rows.append(f"<tr><td>{words}</td>{cells}</tr>")
    return "<table>\n" + "\n".join(rows) + "\n</table>"


def missed_sentence(metrics: Mapping[str, Any]) -> str:
    """Return how many wet pixels missed the bottom, and why."""
    missed = {cause: count for cause, count in metrics["missed"].items() if count}
    if not missed:
        return "No wet pixel missed the bottom."
    causes = ", ".join(f"{cause.replace('_', ' ')} {count}" for cause, count in missed.items())
    return f"Of {metrics['pixels_wet']} wet pixels {sum(missed.values())} missed it: {causes}."


def helped_sentence(metrics: Mapping[str, Any]) -> str:
    """Return how many pixels owe their bottom to other frames; nothing where none does."""
    helped = metrics.get("found_with_other_frames", 0)
    if not helped:
        return ""
    return (
        f"{helped} pixels found it with the help of other frames that look there: alone their "
        "echo was too weak."
    )


def frames_set_aside(frames: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return which frames are missing because they could not be flown, if there are any."""
    if not frames:
        return []
    rows = [f"<tr><td>{row['frame']}</td><td>{escape(row['reason'])}</td></tr>" for row in frames]
    return [
        "<h2>Frames set aside</h2>",
        "<p>These failed three times and are missing from all that is told here. "
        "The same command tries them again.</p>",
        f"<table>\n{''.join(rows)}\n</table>",
    ]


def substrates(found: Mapping[str, Mapping[str, Any]]) -> list[str]:
    """Return what was found on each bottom, where there are several."""
    if len(found) < 2:
        return []
    head = "".join(f"<td>{words}</td>" for words in ("bottom", *SUBSTRATE_COLUMNS.values()))
    rows = [f"<tr>{head}</tr>"]
    for name, values in found.items():
        cells = "".join(f"<td>{_number(values[key])}</td>" for key in SUBSTRATE_COLUMNS)
        rows.append(f"<tr><td>{escape(name)}</td>{cells}</tr>")
    return ["<h2>What the bottom is made of</h2>", "<table>", *rows, "</table>"]


def overlaps(found: Sequence[Mapping[str, Any]], adjustment: str) -> list[str]:
    """Return how lines differ where they overlap."""
    if not found:
        return []
    head = "".join(f"<td>{words}</td>" for words in ("lines", *OVERLAP_COLUMNS.values()))
    rows = [f"<tr>{head}</tr>"]
    for pair in found:
        cells = "".join(f"<td>{_number(pair[key])}</td>" for key in OVERLAP_COLUMNS)
        rows.append(f"<tr><td>{pair['lines'][0]} and {pair['lines'][1]}</td>{cells}</tr>")
    how = "not adjusted" if adjustment == "none" else f"adjusted: {escape(adjustment)}"
    return [
        "<h2>Where lines overlap</h2>",
        f"<p>Mean elevations of cells, the later less the earlier line; strips {how}. "
        "strip_differences.tif maps them.</p>",
        *("<table>", *rows, "</table>"),
    ]


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}" if isinstance(value, float) else f"{value}"


def provenance(manifest: Mapping[str, Any]) -> list[str]:
    """Return what made the run: hashes of scenario, files and code, and versions."""
    rows = [("scenario", manifest["scenario_sha256"]), ("code", manifest["code_sha256"])]
    rows += sorted(manifest["files_sha256"].items())
    rows += sorted(manifest["versions"].items())
    cells = "".join(f"<tr><td>{escape(name)}</td><td>{escape(v)}</td></tr>" for name, v in rows)
    return [
        "<h2>Provenance</h2>",
        "<p>SHA-256 of what was flown and of the code that flew it, and versions: another run of "
        "the same has the same points. scenario.toml beside this page is the whole mission.</p>",
        f"<table>{cells}</table>",
    ]
