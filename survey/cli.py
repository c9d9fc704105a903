"""The command `bathyflash`."""

from __future__ import annotations

import os
import sys
import traceback
from pathlib import Path
from typing import Annotated, Any, Literal

import typer
from typer.core import TyperGroup

from survey import export_console, waveforms_console
from survey.exit_status import BAD_INPUT, FILE_MISSING, OUR_FAULT, TRACEBACK_VARIABLE, explain

Settings = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="SECTION.KEY=VALUE", help="Change one value; may be repeated."),
]
ScenarioName = Annotated[
    str, typer.Argument(metavar="SCENARIO", help="A scenario file, or a name of the gallery.")
]
LARGEST_SEED = 2**63 - 1
Seed = Annotated[int, typer.Option(min=0, max=LARGEST_SEED, help="Start of the random numbers.")]


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
    scenario: ScenarioName,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="RUN", help="Run folder.")],
    workers: Annotated[
        int | None, typer.Option(min=0, help="Frames at once; 0 is one for each core.")
    ] = None,
    kind: Annotated[
        Literal["threads", "processes"] | None,
        typer.Option("--with", help="What the workers are. [processes]"),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS|FILE", help="Fly on a dask cluster. [DASK_SCHEDULER_ADDRESS if set]"
        ),
    ] = None,
    frames: Annotated[
        str | None, typer.Option(metavar="A:B", help="Only these frames, from 0, B excluded.")
    ] = None,
    settings: Settings = None,
    refly: Annotated[
        bool, typer.Option("--refly", help="Start over: remove an earlier run in RUN.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")] = False,
) -> None:
    """Fly a mission and write its run folder; go on where an earlier run of it stopped."""
    from survey.console import watching
    from survey.crew.hire import cluster_of, hired
    from survey.interrupt import stoppable
    from survey.scenario.components import flight_plan
    from survey.scenario.load import load_scenario, parse_frames, parse_overrides

    cluster = cluster_of(cluster, workers=workers, kind=kind)
    flown = load_scenario(scenario, parse_overrides(settings or []))
    chosen = parse_frames(frames, flight_plan(flown).frame_count)
    from survey.mission import fly

    workers = flown.run.workers if workers is None else workers
    with (
        stoppable(),
        watching(sys.stdout, quiet=quiet) as watcher,
        hired(workers=workers, kind=kind or "processes", cluster=cluster) as crew,
    ):
        fly(
            flown,
            output,
            crew=crew,
            frames=chosen,
            refly=refly,
            watch=watcher,
        )


@app.command()
def status(
    run: Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.")],
) -> None:
    """Show how far a run is, from another terminal."""
    from survey.run_status import RunStatus

    for line in RunStatus.of(run).lines:
        typer.echo(line)


@app.command()
def check(
    scenarios: Annotated[list[str], typer.Argument(metavar="SCENARIO...", help="Files or names.")],
    settings: Settings = None,
) -> None:
    """Check scenario files and show all their faults at once."""
    from survey.scenario.components import flight_size
    from survey.scenario.gate_notes import gate_notes
    from survey.scenario.load import load_scenario, parse_overrides
    from survey.scenario.seabed_files import require_readable_files
    from survey.scenario.sun import sun_notes
    from survey.scenario.water_notes import water_notes

    overrides, statuses = parse_overrides(settings or []), set()
    for name in scenarios:
        try:
            sound = load_scenario(name, overrides)
            require_readable_files(sound)
        except (ValueError, OSError) as error:
            status, lines = explain(error)
            typer.echo(lines, err=True)
            statuses.add(status)
        else:
            typer.echo(f"{sound.name}: sound, {flight_size(sound)}")
            notes = (*water_notes(sound), *sun_notes(sound.sun, sound.surface), *gate_notes(sound))
            for note in notes:
                typer.echo(f"{sound.name}: {note}")
    for status in (OUR_FAULT, BAD_INPUT, FILE_MISSING):
        if status in statuses:
            raise typer.Exit(status)


@app.command()
def plan(
    scenario: ScenarioName,
    settings: Settings = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, not a table.")] = False,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Map, PNG or SVG.")] = None,
) -> None:
    """Say what a flight will come to, before any light is traced: overlap, gaps, depth, cost."""
    from survey.planning import picture
    from survey.scenario.load import load_scenario, parse_overrides

    if plot is not None:
        picture.require_place(plot)
    ordered = load_scenario(scenario, parse_overrides(settings or []))
    from survey.planning import report
    from survey.planning.plan import make_plan
    from survey.products.json_file import json_bytes

    found = make_plan(ordered)
    for warning in report.warnings(found):
        typer.echo(f"WARNING: {warning}", err=True)
    if plot is not None:
        picture.draw(plot, found)
    if as_json:
        typer.echo(json_bytes(report.as_json(found)).decode(), nl=False)
    else:
        typer.echo(report.as_text(found))


@app.command()
def effects(
    scenario: ScenarioName,
    settings: Settings = None,
    frames: Annotated[
        str | None, typer.Option(metavar="A:B", help="Only these frames, from 0, B excluded.")
    ] = None,
    workers: Annotated[
        int, typer.Option(min=0, help="Frames at once; 0 is one for each core.")
    ] = 0,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, not a table.")] = False,
) -> None:
    """Fly a mission without each of its effects in turn, and say what each costs."""
    from survey.scenario.components import flight_plan
    from survey.scenario.load import load_scenario, parse_frames, parse_overrides

    flown = load_scenario(scenario, parse_overrides(settings or []))
    chosen = parse_frames(frames, flight_plan(flown).frame_count)
    from survey.effects import report
    from survey.effects.costs import costs
    from survey.products.json_file import json_bytes

    found = []
    if not as_json:
        typer.echo(report.heading())
    for cost in costs(flown, frames=chosen, workers=workers):
        found.append(report.as_json(cost))
        if not as_json:
            typer.echo(report.row(cost))
    if as_json:
        typer.echo(json_bytes({"costs": found}).decode(), nl=False)


@app.command()
def adjust(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="A flown run.")],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Adjusted products.")
    ],
    mode: Annotated[
        Literal["boresight", "offsets"],
        typer.Option(help="Angles of the mounting and offsets of lines, or offsets alone."),
    ] = "boresight",
    largest_error: Annotated[
        float,
        typer.Option(
            "--largest-error-m", min=0.001, help="What is told worse than this is left alone."
        ),
    ] = 0.25,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, not a table.")] = False,
) -> None:
    """Bring the lines of a run together where their overlaps have shape; the run stays as it is."""
    from survey import adjustment_report as report
    from survey.adjustment import adjust_run, write_adjustment
    from survey.products.json_file import json_bytes

    found = adjust_run(folder, output, mode=mode, largest_error=largest_error)
    told = report.as_json(found)
    write_adjustment(output, told)
    typer.echo(json_bytes(told).decode() if as_json else report.as_text(found), nl=not as_json)


@app.command()
def scenarios() -> None:
    """List the scenarios that come with the package, and what each shows."""
    from survey.scenario.gallery import gallery, shows

    names = gallery()
    width = max(map(len, names))
    for name, file in names.items():
        typer.echo(f"{name:{width}}  {shows(file)}")


@app.command()
def view(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.")],
    screenshot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="The picture to write, PNG.")
    ] = None,
    web: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="A page for any browser, one file.")
    ] = None,
    movie: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="A fly-over along the flight lines, MP4 or GIF."),
    ] = None,
    points: Annotated[
        int, typer.Option(min=1, help="At most so many bottom points on the page.")
    ] = 2_000_000,
    pixels: Annotated[
        int | None,
        typer.Option(
            "--waveforms",
            min=0,
            metavar="N",
            help="Pixels whose waveforms the page shows; 64 a frame flown again. [512]",
        ),
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")] = False,
) -> None:
    """Open a finished run in a window, or make of it a picture, a page or a movie."""
    from survey.console import watching
    from survey.errors import OtherRunError, UserError

    try:
        if screenshot is None and web is None and movie is None:
            from viewer.desktop.window import open_window

            with watching(sys.stdout, quiet=quiet) as watcher:
                open_window(folder, watch=watcher)
        if screenshot is not None:
            from viewer.screenshot import screenshot as draw

            draw(folder, screenshot)
        if web is not None:
            from viewer.web.make import make_page

            with watching(sys.stdout, quiet=quiet) as watcher:
                make_page(folder, web, points=points, pixels=pixels, watch=watcher)
        if movie is not None:
            from viewer.desktop.movie import make_movie

            with watching(sys.stdout, quiet=quiet) as watcher:
                make_movie(folder, movie, watch=watcher)
    except OtherRunError:
        raise
    except (ValueError, RuntimeError) as fault:
        raise UserError(str(fault)) from fault


@app.command()
def report(
    first: Annotated[Path, typer.Argument(metavar="RUN", help="A finished run.")],
    second: Annotated[Path, typer.Argument(metavar="RUN_B", help="Another to compare it with.")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE", help="Page, HTML.")],
) -> None:
    """Compare two finished runs on a page; each run has a report.html of its own."""
    from survey.report_comparison import write_comparison

    write_comparison(first, second, output)
    typer.echo(f"written to {output}")


app.command()(waveforms_console.waveforms)
app.command()(export_console.export)


@app.command()
def score(
    cloud: Annotated[Path, typer.Argument(metavar="CLOUD", help="LAS, LAZ, PLY or CSV.")],
    folder: Annotated[Path, typer.Option("--run", metavar="RUN", help="Whose truth to score by.")],
    as_json: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Also write all of it here.")
    ] = None,
    bottom_class: Annotated[
        list[int] | None,
        typer.Option(min=0, max=255, help="Class that is bottom; may be repeated. [40 and 43]"),
    ] = None,
) -> None:
    """Score anybody's processed cloud against the truth of a run."""
    from survey.products.json_file import write_json
    from survey.score.report import as_text
    from survey.score.score import BOTTOM, require_place, score_cloud

    if as_json is not None:
        require_place(as_json)
    found = score_cloud(cloud, folder, bottom=tuple(bottom_class or BOTTOM))
    if as_json is not None:
        write_json(as_json, found)
    typer.echo(as_text(found))


@app.command()
def response(
    water: Annotated[
        str | None, typer.Option(metavar="NAME", help="clear, coastal or harbor.")
    ] = None,
    a: Annotated[float | None, typer.Option("--a", help="Absorption [1/m].")] = None,
    b: Annotated[float | None, typer.Option("--b", help="Scattering [1/m].")] = None,
    phase_function: Annotated[
        str | None,
        typer.Option(
            metavar="CSV|KIND", help="Table angle_deg,value, or a kind such as average_particle."
        ),
    ] = None,
    illumination: Annotated[
        Literal["flood", "isolated"],
        typer.Option(help="Whether light of all pixels or its own alone reaches a pixel."),
    ] = "flood",
    bottom_depth: Annotated[float, typer.Option(metavar="M", help="Depth [m].")] = 20.0,
    seed: Seed = 1,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, not a table.")] = False,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="PNG or SVG.")] = None,
) -> None:
    """Compute what one uniform water column sends back: column and bottom, with errors."""
    import json

    from survey import response_report as report

    chosen = report.water_of(
        name=water,
        absorption=a,
        scattering=b,
        phase_function=phase_function,
        bottom_depth=bottom_depth,
        plot=plot,
    )
    from survey.transport.response import response as compute

    found = compute(water=chosen, illumination=illumination, bottom_depth=bottom_depth, seed=seed)
    if plot is not None:
        title = f"{chosen.phase_function.name}, {illumination}: "
        title += f"a = {chosen.absorption:g}, b = {chosen.scattering:g} 1/m"
        report.draw(plot, found, title=title)
    typer.echo(json.dumps(report.as_json(found), indent=1) if as_json else report.as_text(found))


@app.command()
def paper(
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Results.")],
    work: Annotated[
        float, typer.Option(help="Walks over those of the full computation, 0.01 to 100.")
    ] = 1.0,
    seed: Seed = 1,
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 is one for each core.")] = 0,
    flights: Annotated[
        bool,
        typer.Option("--flights", help="Also fly its missions into DIR/flights: 20 minutes."),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, not a table.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")] = False,
) -> None:
    """Compute the paper's figures 1-3 and six depths anew, and whether its receiver can exist."""
    from survey.paper.output import require_place, write_results

    require_place(output)
    from survey import paper_console as console
    from survey.paper.figures import pictures
    from survey.paper.report import as_json as plain
    from survey.paper.reproduce import reproduce
    from survey.products.json_file import json_bytes

    with console.telling(sys.stderr if as_json else sys.stdout, quiet=quiet) as tell:
        findings = reproduce(work=work, seed=seed, threads=threads, tell=tell)
    result = plain(findings, work=work, seed=seed)
    write_results(output, pictures(findings) | {"paper.json": json_bytes(result)})
    if not (as_json or quiet):
        console.say(findings, sys.stdout)
    if flights:
        from survey.paper_flights import FLIGHTS, fly_all, limits_of
        from survey.products.json_file import write_json

        stream = sys.stderr if as_json else sys.stdout
        with console.telling(stream, quiet=quiet, steps=len(FLIGHTS)) as tell:
            flown = fly_all(output / "flights", limits=limits_of(findings), tell=tell)
        result["flights"] = flown
        write_json(output / "paper.json", result)
        if not (as_json or quiet):
            console.say_flights(flown, sys.stdout)
    if as_json:
        typer.echo(json_bytes(result).decode(), nl=False)


@app.command()
def bench(
    threads: Annotated[int, typer.Option(min=0, help="Threads; 0 is one for each core.")] = 0,
    merit: Annotated[
        bool, typer.Option("--merit", help="Compare with the textbook engine: ten minutes.")
    ] = False,
    scaling: Annotated[
        bool, typer.Option("--scaling", help="How time grows with pixels, b z and mesh instead.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON, not a table.")] = False,
) -> None:
    """Measure speed at a measured error, on four waters."""
    import json

    from survey import bench as benchmark

    if scaling:
        from survey.bench_scaling import scaling as rows_of_scaling

        rows = []
        for row in rows_of_scaling():
            rows.append(row)
            if not as_json:
                pairs = zip(row["sizes"], row["seconds"], strict=True)
                timed = "  ".join(f"{size:g}: {seconds:.3f} s" for size, seconds in pairs)
                typer.echo(f"{row['name']:18}{timed}  exponent {row['exponent']:.2f}")
        if as_json:
            whole = {"scaling": rows} | benchmark.machine(threads=threads)
            typer.echo(json.dumps(whole, indent=1))
        return

    cases = {}
    for case, figures in benchmark.bench(threads=threads, merit=merit):
        cases[case] = figures
        if not as_json:
            shown = {key: value for key, value in figures.items() if isinstance(value, float)}
            typer.echo(
                f"{case:14}" + "".join(f"  {key} {value:.4g}" for key, value in shown.items())
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
