"""The command `bathyflash`."""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from typer.core import TyperGroup

from survey.exit_status import BAD_INPUT, FILE_MISSING, OUR_FAULT, TRACEBACK_VARIABLE, explain

Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="SECTION.KEY=VALUE", help="Change one value; may be repeated."),
]


class Guarded(TyperGroup):
    """Turns every error into its lines for the user and its exit status."""

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except (Exception, KeyboardInterrupt) as error:
            if _is_typer_own(error):
                raise
            status, lines = explain(error)
            if status == OUR_FAULT and os.environ.get(TRACEBACK_VARIABLE):
                traceback.print_exc()
            typer.echo(lines, err=True)
            raise typer.Exit(status) from None


def _is_typer_own(error: BaseException) -> bool:
    return isinstance(error, BrokenPipeError | typer.Exit | typer.Abort) or hasattr(
        error, "exit_code"
    )


app = typer.Typer(
    cls=Guarded,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    help="Simulate airborne bathymetric surveys with a photon-counting flash lidar.",
)


@app.command()
def run(
    scenario: Annotated[str, typer.Argument(help="A scenario file, or a name of the gallery.")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="RUN", help="Run folder.")],
    workers: Annotated[
        int | None, typer.Option(min=0, help="Frames at once; 0 is one for each core.")
    ] = None,
    frames: Annotated[
        str | None, typer.Option(metavar="A:B", help="Only these frames, from 0, B excluded.")
    ] = None,
    settings: Settings = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")] = False,
) -> None:
    """Fly a mission and write its run folder."""
    from survey.console import watching
    from survey.scenario.load import load_scenario, parse_frames, parse_overrides

    flown = load_scenario(scenario, parse_overrides(settings or []))
    chosen = parse_frames(frames, flown.flight.lines * flown.flight.frames_per_line)
    from survey.mission import fly

    with watching(sys.stdout, quiet=quiet) as watcher:
        fly(
            flown,
            output,
            workers=flown.run.workers if workers is None else workers,
            frames=chosen,
            watch=watcher,
        )


@app.command()
def check(
    scenarios: Annotated[list[str], typer.Argument(metavar="SCENARIO...", help="Files or names.")],
    settings: Settings = None,
) -> None:
    """Check scenario files and show all their faults at once."""
    from survey.scenario.load import load_scenario, parse_overrides

    overrides, statuses = parse_overrides(settings or []), set()
    for name in scenarios:
        try:
            sound = load_scenario(name, overrides)
        except (ValueError, OSError) as error:
            status, lines = explain(error)
            typer.echo(lines, err=True)
            statuses.add(status)
        else:
            flight = sound.flight
            size = f"lines x frames: {flight.lines} x {flight.frames_per_line}"
            typer.echo(f"{sound.name}: sound, {size}")
    for status in (OUR_FAULT, BAD_INPUT, FILE_MISSING):
        if status in statuses:
            raise typer.Exit(status)


@app.command()
def scenarios() -> None:
    """List the scenarios that come with the package."""
    from survey.scenario.gallery import gallery, title

    names = gallery()
    width = max(map(len, names))
    for name, file in names.items():
        typer.echo(f"{name:{width}}  {title(file)}")


@app.command()
def view(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.")],
    screenshot: Annotated[Path, typer.Option(metavar="FILE", help="The picture to write, PNG.")],
) -> None:
    """Draw a finished run: seabed, water surface and flight."""
    from survey.errors import UserError
    from viewer.screenshot import screenshot as draw

    try:
        draw(folder, screenshot)
    except (ValueError, RuntimeError) as fault:
        raise UserError(str(fault)) from fault


@app.command()
def response(
    water: Annotated[
        str | None, typer.Option(metavar="NAME", help="clear, coastal or harbor.")
    ] = None,
    a: Annotated[float | None, typer.Option("--a", help="Absorption [1/m].")] = None,
    b: Annotated[float | None, typer.Option("--b", help="Scattering [1/m].")] = None,
    phase_function: Annotated[
        Path | None, typer.Option(metavar="CSV", help="Table angle_deg,value.")
    ] = None,
    illumination: Annotated[
        Literal["flood", "isolated"], typer.Option(help="Who lights a pixel.")
    ] = "flood",
    bottom_depth: Annotated[float, typer.Option(metavar="M", help="Depth [m].")] = 20.0,
    seed: Annotated[int, typer.Option(min=0)] = 1,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, not a table.")] = False,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="PNG or SVG.")] = None,
) -> None:
    """Compute what one uniform water column sends back: column and bottom, with errors."""
    import json

    from survey import response_report as report

    chosen = report.water_of(name=water, absorption=a, scattering=b, phase_function=phase_function)
    from survey.transport.response import response as compute

    found = compute(water=chosen, illumination=illumination, bottom_depth=bottom_depth, seed=seed)
    if plot is not None:
        title = f"{chosen.phase_function.name}, {illumination}: "
        title += f"a = {chosen.absorption:g}, b = {chosen.scattering:g} 1/m"
        report.draw(plot, found, title=title)
    typer.echo(json.dumps(report.as_json(found), indent=1) if as_json else report.as_text(found))


@app.command()
def bench(
    threads: Annotated[int, typer.Option(min=0, help="0 is one for each core.")] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, not a table.")] = False,
) -> None:
    """Measure speed at a measured error, on four waters."""
    import json

    from survey import bench as benchmark

    cases = {}
    for name, figures in benchmark.bench(threads=threads):
        cases[name] = figures
        if not as_json:
            typer.echo(
                f"{name:14}" + "".join(f"  {key} {value:.4g}" for key, value in figures.items())
            )
    if as_json:
        typer.echo(json.dumps({"cases": cases} | benchmark.machine(threads=threads), indent=1))


@app.command()
def doctor() -> None:
    """Show versions, threads and memory, and try to render a picture."""
    from survey.doctor import examine
    from viewer.rendering import require_rendering

    findings = examine(require_rendering)
    for finding in findings:
        typer.echo(f"{'ok   ' if finding.good else 'FAULT'}  {finding.what:12}  {finding.text}")
    if not all(finding.good for finding in findings):
        raise typer.Exit(BAD_INPUT)


def main() -> None:
    """Run the command line."""
    app(prog_name="bathyflash")


if __name__ == "__main__":
    main()
