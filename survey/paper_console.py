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
DEPTHS = {
    "snr_depth_m": "SNR 10",
    "run_depth_m": "threshold",
    "stitched_depth_m": "reached",
    "stitched_depth_c_z": "c z",
    "stitched_depth_k_d_z": "K_d z",
}
SHARES = {
    "found_fraction": "found",
    "false_bottom_fraction": "false",
    "hidden_false_fraction": "if hidden",
}


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
    """Print how deep the missions reached, beside what was expected."""
    from rich.console import Console
    from rich.table import Table

    table = Table(title="Depth to which missions flown whole find the bottom, in metres")
    table.add_column("", no_wrap=True)
    for heading in (*DEPTHS.values(), *SHARES.values()):
        table.add_column(heading, justify="right")
    for name, row in flown.items():
        table.add_row(
            name,
            *(_number(row[depth]) for depth in DEPTHS),
            *(_share(row[share]) for share in SHARES),
        )
    console = Console(file=stream, width=None if stream.isatty() else WIDTH, highlight=False)
    console.print(table)
    console.print(
        "SNR 10: where the flooding matrix's ratio for the bottom falls to 10. Threshold: to where "
        "nine flashes in ten should fire. False: more than 1 m off; if hidden: the same where the "
        "true bottom fires in less than 1 % of flashes, so that noise alone makes bottoms."
    )


def _number(value: float | None) -> str:
    return "none" if value is None else f"{value:.1f}"


def _share(value: float | None) -> str:
    return "-" if value is None else f"{100.0 * value:.2f} %"


def _table(findings: Findings) -> Table:
    from rich.table import Table

    table = Table(
        title="Depth where the water column's signal-to-noise ratio falls to 10, in metres"
    )
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
