"""What `bathyflash paper` says on a terminal: its steps, the six depths, the verdict."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, TextIO

from survey.paper import instrument
from survey.paper.reproduce import STEPS

if TYPE_CHECKING:
    from rich.table import Table

    from survey.paper.reproduce import Findings

WIDTH = 100


@contextmanager
def telling(stream: TextIO, *, quiet: bool, steps: int = STEPS) -> Iterator[Callable[[str], None]]:
    """Give what takes a line for each step: nobody when quiet, a bar on a terminal, plain lines."""
    if quiet:
        yield lambda step: None
    elif stream.isatty():
        with _bar(stream, steps) as tell:
            yield tell
    else:
        yield lambda step: print(step, file=stream, flush=True)


@contextmanager
def _bar(stream: TextIO, steps: int) -> Iterator[Callable[[str], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=Console(file=stream), transient=True) as bar:
        task = bar.add_task("", total=steps)
        begun = False

        def tell(step: str) -> None:
            nonlocal begun
            bar.update(task, description=step, advance=1 if begun else 0)
            begun = True

        yield tell


def say(findings: Findings, stream: TextIO) -> None:
    """Print the table of the six depths, the receiver, the verdict and the single element."""
    from rich.console import Console

    from survey.paper.single_element import sentences

    console = Console(file=stream, width=None if stream.isatty() else WIDTH, highlight=False)
    console.print(_table(findings))
    fitted, apparent = findings.isolated, findings.apparent
    console.print(
        f"Fitted receiver: aperture radius {fitted.receiver.aperture_radius:.3f} ± "
        f"{fitted.radius_error:.3f} m, filter {fitted.receiver.filter_width * 1e9:.2f} ± "
        f"{fitted.width_error * 1e9:.2f} nm, efficiency {fitted.receiver.efficiency:g} assumed. "
        f"With the paper's depth read as c t / 2 the fit is off by {100.0 * apparent.rms:.1f} % "
        f"r.m.s., {100.0 * apparent.worst:+.1f} % at worst."
    )
    console.print(" ".join(findings.verdict.sentences()))
    console.print()
    console.print(" ".join(sentences(findings.sights)))


def say_flights(flown: Mapping[str, Mapping[str, Any]], stream: TextIO) -> None:
    """Print how deep the missions reached, beside what was expected; depths also as c z, K_d z."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title="Missions flown whole: depth to which the bottom is found [m (c z, K_d z)]")
    for heading in ("", "bed", "ratio 10", "threshold", "reached", "by half", "found", "false"):
        table.add_column(heading, justify="left" if not heading else "right")
    for name, row in flown.items():
        bed = {row["true_depth_least_m"], row["true_depth_greatest_m"]}
        names = ("snr_depth", "run_depth", "stitched_depth", "half_stitched_depth")
        table.add_row(
            name,
            " to ".join(f"{depth:.0f}" for depth in sorted(bed)),
            *(_depth(row, depth) for depth in names),
            f"{100.0 * row['found_fraction']:.1f} %",
            f"{100.0 * row['false_bottom_fraction']:.2f} %",
        )
    Console(file=stream, width=None if stream.isatty() else WIDTH, highlight=False).print(table)


def _depth(row: Mapping[str, Any], name: str) -> str:
    if row[f"{name}_m"] is None:
        return "none"
    return f"{row[f'{name}_m']:.1f} ({row[f'{name}_c_z']:.1f}, {row[f'{name}_k_d_z']:.1f})"


def _table(findings: Findings) -> Table:
    from rich.table import Table

    table = Table(title="Depth where the water column's signal-to-noise ratio falls to 10 [m]")
    for heading in ("", "published", "isolated", "off", "flood, fitted anew", "off"):
        table.add_column(heading, justify="left" if not heading else "right")
    table.add_column("flood, same receiver", justify="right")
    isolated, flood = findings.isolated, findings.flood
    for sun, waters in instrument.PUBLISHED.items():
        for name, published in waters.items():
            table.add_row(
                f"{name}, {sun}",
                f"{published:g}",
                f"{isolated.depths[sun][name]:.2f} ± {isolated.errors[sun][name]:.2f}",
                f"{100.0 * isolated.residuals[sun][name]:+.1f} %",
                f"{flood.depths[sun][name]:.1f}",
                f"{100.0 * flood.residuals[sun][name]:+.0f} %",
                f"{findings.flood_same_receiver[sun][name]:.1f}",
            )
    table.add_section()
    table.add_row(
        "r.m.s.", "", "", f"{100.0 * isolated.rms:.1f} %", "", f"{100.0 * flood.rms:.0f} %", ""
    )
    return table
