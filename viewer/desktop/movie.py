"""`bathyflash view RUN --movie FILE`: a fly-over along the flight lines, MP4 or GIF."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from survey.products.writing import whole_file
from survey.progress import Watcher
from viewer.desktop.content import read_content
from viewer.desktop.flight_path import Moment, moments
from viewer.desktop.movie_files import Picture, format_of
from viewer.desktop.stage import Stage
from viewer.desktop.state import Layer, Reach, ViewState
from viewer.rendering import require_rendering

MOST_POINTS = 300_000
"""Drawn in a picture."""

SHORTEST_S, LONGEST_S = 8.0, 60.0
LAYERS = frozenset({Layer.BOTTOM, Layer.FLIGHT, Layer.LIGHT})


def make_movie(run: Path, file: Path, *, watch: Watcher) -> None:
    """Fly over a finished run as it was flown, and write what is seen.

    Parameters
    ----------
    run : Path
        Run folder.
    file : Path
        Ends in .mp4 or .gif; replaced if it exists.
    watch : Watcher
        Told of every picture.

    Raises
    ------
    FileNotFoundError
        If the run or a file of it is missing.
    UserError
        If the file is neither MP4 nor GIF or has no place, or ffmpeg is missing for MP4.
    RuntimeError
        If this machine cannot render.
    """
    kind = format_of(file)
    content = read_content(run)
    require_rendering()
    import pyvista

    state = replace(content.first_state(kind.size), reach=Reach.SO_FAR, layers=LAYERS)
    path = moments(
        content.flashes,
        water_level=content.flown.water_level,
        exaggeration=state.exaggeration,
        height=kind.size[1],
        rate=kind.rate,
        shortest=SHORTEST_S,
        longest=LONGEST_S,
    )
    plotter = pyvista.Plotter(off_screen=True, window_size=list(kind.size))
    stage = Stage(plotter, content)
    stage.paces["resting"].points = MOST_POINTS
    watch.started(len(path))
    with whole_file(file) as partial:
        kind.write(partial, _pictures(stage, state, path, watch), kind.rate)
    plotter.close()
    size = file.stat().st_size / 1e6
    watch.finished(f"{file}: {len(path) / kind.rate:.0f} s, {size:.1f} MB")


def _pictures(
    stage: Stage, state: ViewState, path: Sequence[Moment], watch: Watcher
) -> Iterator[Picture]:
    for number, moment in enumerate(path):
        begun = time.monotonic()
        stage.apply(state.at_frame(moment.place).seen_from(moment.orbit), flash=moment.flash)
        stage.plotter.render()
        yield np.asarray(stage.plotter.screenshot(return_img=True), dtype=np.uint8)
        watch.frame_done(number, time.monotonic() - begun)
