"""The command `bathyflash waveforms`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from survey.errors import UserError

if TYPE_CHECKING:
    from survey.labelled.flown_run import FlownRun
    from survey.labelled.pixels import Pixels


def waveforms(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="A run folder.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE.zarr", help="What to write.")
    ] = None,
    frames: Annotated[
        str | None, typer.Option(metavar="A:B", help="Only these frames, from 0, B excluded.")
    ] = None,
    every: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="One pixel in N x N.")
    ] = None,
    pixels: Annotated[
        str | None, typer.Option(metavar="A:B,C:D", help="Only rows A:B and columns C:D.")
    ] = None,
    pixel: Annotated[
        str | None, typer.Option(metavar="FRAME,ROW,COLUMN", help="One pixel, for --plot.")
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw --pixel, PNG or SVG.")
    ] = None,
    workers: Annotated[
        int, typer.Option(min=0, help="Frames at once; 0 is one for each core.")
    ] = 0,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace other waveforms at -o.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")] = False,
) -> None:
    """Write a run's waveforms by origin, labelled with the truth, or draw those of one pixel."""
    _require_a_task(output, pixel, plot)
    from survey.labelled.flown_run import FlownRun

    run = FlownRun.open(folder)
    if plot is not None and pixel is not None:
        _draw(run, pixel, plot)
    if output is not None:
        from survey.console import watching
        from survey.labelled.export import write_waveforms
        from survey.scenario.components import flight_plan
        from survey.scenario.load import parse_frames

        chosen = parse_frames(frames, flight_plan(run.scenario).frame_count)
        with watching(sys.stdout, quiet=quiet) as watcher:
            write_waveforms(
                run,
                output,
                pixels=_pixels(every, pixels, run),
                frames=chosen,
                workers=workers,
                overwrite=overwrite,
                watch=watcher,
            )


def _require_a_task(output: Path | None, pixel: str | None, plot: Path | None) -> None:
    if (pixel is None) != (plot is None):
        raise UserError("--pixel and --plot go together: --pixel FRAME,ROW,COLUMN --plot FILE")
    if output is None and plot is None:
        raise UserError("nothing to do. Name a zarr with -o, or a pixel and a picture with --plot")
    if plot is not None:
        from survey.planning.picture import require_place

        require_place(plot)


def _pixels(every: int | None, pixels: str | None, run: FlownRun) -> Pixels:
    from survey.labelled.pixels import Pixels

    shape = run.scenario.camera.rows, run.scenario.camera.columns
    if pixels is None:
        return Pixels.every(every or 1, shape)
    if every is not None:
        raise UserError("--every and --pixels: give one of them")
    return Pixels.parse(pixels, shape)


def _draw(run: FlownRun, pixel: str, plot: Path) -> None:
    from survey.labelled.picked import PickedPixels, parse_pixel
    from survey.labelled.picture import draw

    frame, row, column = parse_pixel(pixel)
    draw(plot, PickedPixels(run).waveform(frame=frame, row=row, column=column))
