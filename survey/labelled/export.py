"""The labelled waveforms of a run: its frames flown again, checked, written as one zarr folder."""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from survey.errors import UserError
from survey.labelled.attributes import scenario_attributes
from survey.labelled.dataset import dataset_of, with_tags
from survey.labelled.flown_run import FlownRun
from survey.labelled.pixels import Pixels
from survey.labelled.store import Layout, open_waveforms, write_blocks
from survey.mission import observe
from survey.preparation import Mission, prepare
from survey.products.writing import whole_folder
from survey.progress import Unwatched, Watcher

if TYPE_CHECKING:
    import xarray


def write_waveforms(
    run: FlownRun,
    output: Path,
    *,
    pixels: Pixels,
    frames: range | None = None,
    workers: int = 0,
    overwrite: bool = False,
    watch: Watcher | None = None,
) -> Path:
    """Fly frames of a run again and write their labelled waveforms, whole or not at all.

    Memory holds one block of frames, see `survey.labelled.store.Layout`, and those in flight. The
    bytes do not depend on the number of workers.

    Parameters
    ----------
    run : FlownRun
    output : Path
        The zarr folder to write.
    pixels : Pixels
        Which pixels of every frame.
    frames : range, optional
        Only these; all that are whole without it.
    workers : int
        Frames flown at once; 0 is one for each core.
    overwrite : bool
        Whether another set of waveforms at ``output`` is replaced. The same set stays as it is.
    watch : Watcher, optional
        Is told of the progress.

    Raises
    ------
    OtherRunError
        When a frame flown again is not the run's own: the run is of other code.
    UserError
        When frames are not in the run, or something else is in the way.
    """
    watch = watch or Unwatched()
    numbers = run.chosen(frames)
    if output.exists() and not overwrite:
        _require_same(output, run, numbers, pixels)
        watch.finished(f"{output}: these waveforms are there already, and whole")
        return output
    _require_place(output)
    mission = with_tags(prepare(run.scenario))
    layout = Layout.of(
        frames=len(numbers),
        rows=pixels.shape[0],
        columns=pixels.shape[1],
        bins=mission.engine.receiver.bins,
    )
    watch.started(len(numbers))
    attributes = {**scenario_attributes(run.scenario), **run.identity}
    flown = _flown_again(run, mission, numbers, pixels, workers, watch)
    with whole_folder(output) as partial:
        write_blocks(
            partial,
            (block.assign_attrs(attributes) for block in _blocks(flown, layout.block)),
            layout=layout,
        )
    watch.finished(_summary(output, len(numbers), pixels))
    return output


def _flown_again(
    run: FlownRun,
    mission: Mission,
    numbers: Sequence[int],
    pixels: Pixels,
    workers: int,
    watch: Watcher,
) -> Iterator[xarray.Dataset]:
    """Yield the frames in their order, each compared with the run's own."""

    def flown(index: int) -> tuple[int, xarray.Dataset, float]:
        start = time.perf_counter()
        seen = observe(mission, mission.frames[index])
        run.require_same(index, seen.result)
        return index, dataset_of(mission, seen, pixels), time.perf_counter() - start

    for index, dataset, seconds in in_order(flown, numbers, workers or os.cpu_count() or 1):
        watch.frame_done(index, seconds)
        yield dataset


def in_order(work: Callable[[int], Any], numbers: Sequence[int], workers: int) -> Iterator[Any]:
    """Yield the work on every number, in their order; no more is ahead than there are workers.

    Examples
    --------
    >>> list(in_order(lambda n: n * n, [3, 1, 2], workers=2))
    [9, 1, 4]
    """
    pool, ahead = ThreadPoolExecutor(workers), deque[Future[Any]]()
    try:
        for number in numbers:
            ahead.append(pool.submit(work, number))
            if len(ahead) > workers:
                yield ahead.popleft().result()
        while ahead:
            yield ahead.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)


def _blocks(frames: Iterator[xarray.Dataset], size: int) -> Iterator[xarray.Dataset]:
    block: list[xarray.Dataset] = []
    for frame in frames:
        block.append(frame)
        if len(block) == size:
            yield joined(block)
            block = []
    if block:
        yield joined(block)


def joined(frames: Sequence[xarray.Dataset]) -> xarray.Dataset:
    """Return data sets of single frames as one, their time tags one after the other."""
    import xarray

    has_tags = [name for name, part in frames[0].variables.items() if "tag" in part.dims]
    how: dict[str, Any] = {"data_vars": "minimal", "coords": "minimal", "compat": "override"}
    whole = xarray.concat(
        [frame.drop_vars(has_tags) for frame in frames], "frame", join="override", **how
    )
    if has_tags:
        tags = [frame[has_tags].reset_coords(drop=True) for frame in frames]
        whole = whole.merge(xarray.concat(tags, "tag"))
    return whole


def _require_place(output: Path) -> None:
    if not output.parent.is_dir():
        raise UserError(f"{output}: there is no folder {output.parent}. Make it first")
    if output.exists() and not (output / ".zgroup").is_file():
        raise UserError(f"{output}: holds something else. Choose another name with -o")


def _require_same(output: Path, run: FlownRun, numbers: list[int], pixels: Pixels) -> None:
    """Raise unless a set of waveforms is whole, of this run, these frames and these pixels."""
    found = open_waveforms(output)
    same = all(found.attrs.get(key) == value for key, value in run.identity.items())
    wanted = {"frame": numbers, "row": list(pixels.rows), "column": list(pixels.columns)}
    same &= all(found[name].values.tolist() == place for name, place in wanted.items())
    if not same:
        raise UserError(
            f"{output}: holds the waveforms of another run, other frames or other pixels. "
            "Choose another name with -o, or --overwrite"
        )


def _summary(output: Path, frames: int, pixels: Pixels) -> str:
    size = sum(path.stat().st_size for path in output.rglob("*") if path.is_file())
    rows, columns = pixels.shape
    return (
        f"{output}: frames x rows x columns: {frames} x {rows} x {columns}, "
        f"{size / 1e6:.1f} MB, {size / frames / 1e6:.3f} MB a frame"
    )
