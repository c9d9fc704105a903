"""`bathyflash view RUN --web FILE.html`: what is needed is gathered, the page written whole."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from survey.errors import OtherRunError, UserError
from survey.labelled.flown_run import FlownRun
from survey.products.writing import write_whole
from survey.progress import Watcher
from survey.scenario import components
from terrain.seabed import Seabed
from viewer.run_folder import read_run
from viewer.web.page import html, page_contents
from viewer.web.points import chosen_points
from viewer.web.seabed import true_seabed
from viewer.web.waveforms import waveforms

MOST_POINTS = 2_000_000
PIXELS = 512


def make_page(
    folder: Path, file: Path, *, points: int = MOST_POINTS, pixels: int | None, watch: Watcher
) -> None:
    """Write a page of a finished run.

    Parameters
    ----------
    folder : Path
        Run folder.
    file : Path
        HTML to write, replaced if it exists.
    points : int
        At most so many of the bottom.
    pixels : int, optional
        Whose waveforms are shown, 64 of a frame that is flown again; none for 0. Without it 512,
        or none if the run is of other code.
    watch : Watcher
        Told of frames flown again, and of what has to be left out.

    Raises
    ------
    FileNotFoundError
        If the run or a file of it is missing.
    UserError
        If it cannot be shown or there is no place for the file.
    OtherRunError
        If pixels were asked for and frames flown again are not the run's own.
    """
    require_place(file)
    run, flown = FlownRun.open(folder), read_run(folder)
    chosen = chosen_points(flown, at_most=points)
    seabed = _seabed(run, watch)
    contents = page_contents(
        flown,
        chosen,
        waveforms=_waveforms(run, pixels, watch),
        seabed=true_seabed(seabed, chosen["bottom"].cloud) if seabed else None,
        substrates=seabed.substrate_names if seabed else {},
    )
    content = html(contents).encode()
    write_whole(file, content)
    watch.finished(f"{file}: {len(content) / 1e6:.1f} MB, opens in any browser without a network")


def require_place(file: Path) -> None:
    """Raise `UserError` unless a page can be written there.

    Examples
    --------
    >>> require_place(Path("wreck.txt"))
    Traceback (most recent call last):
    survey.errors.UserError: wreck.txt: not a page. Name a file that ends in .html
    """
    if file.suffix.lower() not in (".html", ".htm"):
        raise UserError(f"{file}: not a page. Name a file that ends in .html")
    if file.is_dir():
        raise UserError(f"{file}: is a folder. Name a file that ends in .html")
    if not file.parent.is_dir():
        raise UserError(f"{file}: no folder {file.parent}. Make it first")


def _seabed(run: FlownRun, watch: Watcher) -> Seabed | None:
    try:
        return components.seabed(run.scenario)
    except (OSError, ValueError) as fault:
        watch.noticed(f"the true seabed and names of substrates are left out: {fault}")
        return None


def _waveforms(run: FlownRun, pixels: int | None, watch: Watcher) -> dict[str, Any] | None:
    if pixels == 0:
        return None
    try:
        return waveforms(run, at_least=PIXELS if pixels is None else pixels, watch=watch)
    except OtherRunError as fault:
        if pixels is not None:
            raise OtherRunError(f"{fault}; or leave waveforms out: --waveforms 0") from fault
        watch.noticed(f"waveforms are left out: {fault}")
        return None
