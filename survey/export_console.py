"""The command ``bathyflash export``."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer


def export(
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="A finished run folder.")],
    to: Annotated[
        str,
        typer.Option(
            metavar="LIST", help="las, laz, copc, ply, glb, obj, stl, tif, cog, zarr; commas."
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FOLDER", help="Where to; RUN/export unless told."),
    ] = None,
    standard_only: Annotated[
        bool,
        typer.Option("--standard-only", help="Clouds without our own columns, hence no truth."),
    ] = False,
    cell: Annotated[
        float | None,
        typer.Option(
            "--cell-m", min=0.01, metavar="M", help="Cells of grids and meshes; the run's if not."
        ),
    ] = None,
) -> None:
    """Write a finished run in the formats of other programs."""
    from survey.console import watching
    from survey.export import FinishedRun, export_run, parse_formats

    formats = parse_formats(to)
    run = FinishedRun.open(folder, cell_size=cell)
    chosen = folder / "export" if output is None else output
    with watching(sys.stdout, quiet=False) as watch:
        files = export_run(run, chosen, formats=formats, standard_only=standard_only, watch=watch)
        for path in files:
            typer.echo(f"{path}  {_size(path) / 1e6:.2f} MB")


def _size(path: Path) -> int:
    """Return how many bytes a file or the files in a folder have."""
    return path.stat().st_size if path.is_file() else sum(map(_size, path.iterdir()))
