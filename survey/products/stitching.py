"""From the frames of a mission to its tiles, each read twice and never held together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain, islice

from survey.flight.pose import Frame
from survey.products.first_look import FirstLook
from survey.products.frame_file import FrameResult
from survey.products.map_tiles import map_tiles
from survey.products.read_ahead import read_ahead
from survey.products.tile_points import TilePoints, tile_points
from survey.progress import Watcher
from terrain.map_frame import MapFrame

ReadFrame = Callable[[int], FrameResult]
POINTS_OF_A_TILE, FRAMES_AT_ONCE = 400_000, 8


def first_look(
    read: ReadFrame, frames: Sequence[Frame], map_frame: MapFrame, watch: Watcher
) -> FirstLook:
    """Read all frames once, and return what must be known before the first tile.

    Parameters
    ----------
    read : callable
        Returns a frame by its number; called from other threads.
    frames : sequence of Frame
    map_frame : MapFrame
        Where the frames' points lie on the map.
    watch : Watcher
        Is told of the progress.
    """
    look = FirstLook(map_frame)
    watch.writing(2 * len(frames))
    results = read_ahead(read, (frame.index for frame in frames))
    while some := list(islice(results, FRAMES_AT_ONCE)):
        look.add(some)
        watch.written(len(some))
    return look


def stitched_tiles(
    look: FirstLook,
    read: ReadFrame,
    frames: Sequence[Frame],
    map_frame: MapFrame,
    *,
    grid: float,
    thinning: float,
    reach: float,
    watch: Watcher,
) -> Iterator[TilePoints]:
    """Yield what the frames hold tile by tile, overlaps thinned.

    Parameters
    ----------
    look : FirstLook
        At the same frames; the others as there.
    grid, thinning : float
        Sides of the cells in which elevations are gridded and overlaps thinned [m].
    reach : float
        How far a pixel answers for the bottom around it [m].
    """
    tiles = list(
        map_tiles(
            extents=look.extents,
            points=look.points,
            lattice=look.raster(cell_size=grid),
            margin=max(thinning, reach) + grid,
            most=POINTS_OF_A_TILE,
        )
    )
    needed = [[frames[number].index for number in tile.frames] for tile in tiles]
    watch.writing(len(frames) + sum(map(len, needed)))
    results = read_ahead(read, chain.from_iterable(needed))
    for tile, numbers in zip(tiles, needed, strict=True):
        here = islice(results, len(numbers))
        yield tile_points(tile, here, thinning=thinning, map_frame=map_frame)
        watch.written(len(numbers))
