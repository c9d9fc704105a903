"""The report of a run: the mission, the verdict and four figures at once, then all the rest."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from survey.products.coverage import CoverageMap
from survey.products.grids import ElevationMap
from survey.products.reach import reach_sentence
from survey.products.report.curves import depth_histogram, error_by_depth, found_by_strength
from survey.products.report.maps import depth_map, error_histogram, error_map, outcome_map
from survey.products.report.page import Figure, figures, page
from survey.products.report.tables import (
    frames_set_aside,
    helped_sentence,
    key_figures,
    missed_sentence,
    overlaps,
    provenance,
    substrates,
)
from survey.products.tally import ErrorTally
from survey.products.verdict.words import verdict_lines
from survey.products.writing import write_whole

REPORT, FIGURES = "report.html", "figures"


@dataclass(frozen=True, kw_only=True)
class Findings:
    """What a report tells.

    Parameters
    ----------
    title, description : str
        Of the mission, plain text.
    metrics : mapping
        What stands in metrics.json.
    grid : ElevationMap
        Gridded bathymetry.
    error_grid : ElevationMap
        Gridded errors of the bottom points, in the place of elevations [m].
    coverage : CoverageMap
        What became of the bottom.
    errors : ErrorTally
        Elevation errors of the bottom points [m].
    water_level : float
        In the vertical datum [m].
    verdict : sequence of str
        Lines of HTML that say which orders are met, and why not.
    failures : Figure, optional
        Where they are not.
    sample : Figure, optional
        The waveform of one pixel.
    manifest : mapping, optional
        What made the run.
    """

    title: str
    description: str
    metrics: Mapping[str, Any]
    grid: ElevationMap
    error_grid: ElevationMap
    coverage: CoverageMap
    errors: ErrorTally
    water_level: float
    verdict: tuple[str, ...] = ()
    failures: Figure | None = None
    sample: Figure | None = None
    manifest: Mapping[str, Any] | None = None


def write_report(folder: Path, found: Findings) -> None:
    """Write ``report.html``, self-contained, and its figures as files in ``figures``."""
    first, later = list(_first_figures(found)), list(_later_figures(found))
    drawn = [*first, *([found.failures] if found.failures else []), *later]
    (folder / FIGURES).mkdir(exist_ok=True)
    for figure in drawn:
        write_whole(folder / FIGURES / f"{figure.name}.png", figure.png)
    metrics = found.metrics
    lines = [
        f"<h1>{escape(found.title)}</h1>",
        *(f"<p>{escape(text)}</p>" for text in found.description.split("\n\n") if text.strip()),
        f"<p>{_mission(metrics)}</p>",
        *_verdict(metrics),
        *frames_set_aside(metrics.get("frames_set_aside", [])),
        *figures(first),
        "<h2>Key figures</h2>",
        key_figures(metrics),
        f"<p>{reach_sentence(metrics)} {missed_sentence(metrics)} {helped_sentence(metrics)}</p>",
        *found.verdict,
        *([found.failures.html()] if found.failures else []),
        "<h2>Points, errors and detection</h2>",
        *figures(later),
        *substrates(metrics.get("substrates", {})),
        *overlaps(metrics.get("overlaps", []), metrics.get("strip_adjustment", "none")),
        *(provenance(found.manifest) if found.manifest else []),
    ]
    write_whole(folder / REPORT, page(found.title, lines).encode())


def _mission(metrics: Mapping[str, Any]) -> str:
    return (
        f"{metrics['frames']} frames gave {metrics['points_bottom']} bottom points and "
        f"{metrics['points_surface']} of the sea surface. Every one of them is simulated."
    )


def _verdict(metrics: Mapping[str, Any]) -> list[str]:
    if "s44" not in metrics:
        return []
    lines = (f"<p>{escape(line)}</p>" for line in verdict_lines(metrics))
    return ['<div class="verdict">', *lines, "</div>"]


def _first_figures(found: Findings) -> Iterator[Figure]:
    size, level = found.grid.cells.cell_size, found.water_level
    yield Figure(
        name="depth",
        png=depth_map(found.grid, water_level=level),
        words=f"Depth: median of the points in cells of {size:g} m, below the water level at "
        f"{level:+.2f} m in the vertical datum.",
    )
    yield Figure(
        name="holes",
        png=outcome_map(found.coverage),
        words="What became of the bottom: the commonest outcome in cells of "
        f"{found.coverage.cells.cell_size:g} m, holes by their cause.",
    )
    if found.errors.count:
        yield Figure(
            name="errors",
            png=error_map(found.error_grid),
            words=f"Error: median of measured less true elevation in cells of {size:g} m; the "
            "colours end where 95 % of the cells lie.",
        )
    if found.sample:
        yield found.sample


def _later_figures(found: Findings) -> Iterator[Figure]:
    by_depth = found.metrics.get("error_by_depth", [])
    by_strength = found.metrics.get("detection_by_counts", [])
    if found.errors.count:
        yield Figure(
            name="error-histogram",
            png=error_histogram(found.errors),
            words=f"Errors of {found.errors.count} bottom points against the true seabed at the "
            "measured place; the outermost bars hold all that is further off.",
        )
    if by_depth:
        yield Figure(
            name="depth-histogram",
            png=depth_histogram(by_depth),
            words="How many bottom points lie at which measured depth.",
        )
    if any("mean_m" in row for row in by_depth):
        yield Figure(
            name="error-by-depth",
            png=error_by_depth({"mean": by_depth}),
            words="Mean error and the band that holds 95 % of the points, by metres of measured "
            "depth with twenty points or more; false bottoms, more than 1 m off, are left out.",
        )
    if by_strength:
        yield Figure(
            name="detection",
            png=found_by_strength({"found": by_strength}),
            words="How many of the true bottoms were found, by the counts that their echo should "
            "give in a gate, and how many the detection model expects.",
        )
