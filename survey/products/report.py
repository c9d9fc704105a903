"""A page that tells what a mission found, in one file without a network."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from survey.products.coverage import CoverageMap
from survey.products.grids import ElevationMap
from survey.products.reach import reach_sentence
from survey.products.report_figures import depth_map, error_histogram, outcome_map
from survey.products.tally import ErrorTally
from survey.products.writing import write_whole

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
STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 62rem;
       margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; margin-bottom: 0.3rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
table { border-collapse: collapse; } td { padding: 0.25rem 1rem 0.25rem 0;
       border-bottom: 1px solid #ddd; } td:first-child { text-align: right;
       font-variant-numeric: tabular-nums; white-space: nowrap; font-weight: 600; }
img { max-width: 100%; height: auto; }
"""


def write_report(
    path: Path,
    *,
    title: str,
    description: str,
    metrics: Mapping[str, Any],
    grid: ElevationMap,
    coverage: CoverageMap,
    errors: ErrorTally,
    water_level: float,
    verdict: Sequence[str] = (),
) -> None:
    """Write a self-contained HTML page: what was flown, key figures, two maps, a histogram.

    Parameters
    ----------
    path : Path
        File to write.
    title, description : str
        Of the mission, plain text.
    metrics : mapping
        From `survey.products.accuracy.Accuracy`.
    grid : ElevationMap
        Gridded bathymetry.
    coverage : CoverageMap
        What became of the bottom.
    errors : ErrorTally
        Elevation errors of the bottom points [m].
    water_level : float
        In the vertical datum [m].
    verdict : sequence of str
        Lines of HTML that say which order of S-44 is met.
    """
    body = "\n".join(
        [
            f"<h1>{escape(title)}</h1>",
            *(f"<p>{escape(text)}</p>" for text in description.split("\n\n") if text.strip()),
            "<p>Every point of this survey is simulated.</p>",
            *("<h2>Key figures</h2>", _table(metrics)),
            *_set_aside(metrics.get("frames_set_aside", [])),
            *verdict,
            "<h2>Depth</h2>",
            f"<p>Median of the points in cells of {grid.cells.cell_size:g} m, "
            f"below the water level at {water_level:+.2f} m in the vertical datum.</p>",
            _image(depth_map(grid, water_level=water_level), "map of depth"),
            f"<p>{reach_sentence(metrics)}</p>",
            "<h2>What became of the bottom</h2>",
            f"<p>The commonest outcome in cells of {coverage.cells.cell_size:g} m. "
            f"{_missed(metrics)}</p>",
            _image(outcome_map(coverage), "map of outcomes"),
            *_errors(errors),
            *_substrates(metrics.get("substrates", {})),
            *_overlaps(metrics.get("overlaps", []), metrics.get("strip_adjustment", "none")),
        ]
    )
    page = (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n"
        f"<body>\n{body}\n</body>\n</html>\n"
    )
    write_whole(path, page.encode())


def _table(metrics: Mapping[str, Any]) -> str:
    rows = (
        f"<tr><td>{form.format(metrics[name])}</td><td>{words}</td></tr>"
        for name, form, words in ROWS
        if metrics.get(name) is not None
    )
    return "<table>\n" + "\n".join(rows) + "\n</table>"


def _missed(metrics: Mapping[str, Any]) -> str:
    missed = {cause: count for cause, count in metrics["missed"].items() if count}
    if not missed:
        return "No wet pixel missed the bottom."
    causes = ", ".join(f"{cause.replace('_', ' ')} {count}" for cause, count in missed.items())
    return f"Of {metrics['pixels_wet']} wet pixels {sum(missed.values())} missed it: {causes}."


def _set_aside(frames: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return which frames are missing because they could not be flown, if there are any."""
    if not frames:
        return []
    rows = [f"<tr><td>{row['frame']}</td><td>{escape(row['reason'])}</td></tr>" for row in frames]
    return [
        "<h2>Frames set aside</h2>",
        "<p>These failed three times and are missing from all that follows. "
        "The same command tries them again.</p>",
        f"<table>\n{''.join(rows)}\n</table>",
    ]


def _errors(errors: ErrorTally) -> list[str]:
    if errors.count == 0:
        return []
    return [
        "<h2>Error of the bottom points</h2>",
        f"<p>{errors.count} points against the true seabed at the measured place; "
        "the outermost bins hold all that is further off.</p>",
        _image(error_histogram(errors), "histogram of errors"),
    ]


def _substrates(found: Mapping[str, Mapping[str, Any]]) -> list[str]:
    if len(found) < 2:
        return []
    head = "".join(f"<td>{words}</td>" for words in ("bottom", *SUBSTRATE_COLUMNS.values()))
    rows = [f"<tr>{head}</tr>"]
    for name, values in found.items():
        cells = "".join(f"<td>{_number(values[key])}</td>" for key in SUBSTRATE_COLUMNS)
        rows.append(f"<tr><td>{escape(name)}</td>{cells}</tr>")
    return ["<h2>What the bottom is made of</h2>", "<table>", *rows, "</table>"]


def _overlaps(found: Sequence[Mapping[str, Any]], adjustment: str) -> list[str]:
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


def _image(png: bytes, words: str) -> str:
    return f'<img alt="{words}" src="data:image/png;base64,{b64encode(png).decode()}">'
