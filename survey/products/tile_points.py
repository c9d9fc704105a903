"""What the frames hold in one tile of the map, overlaps thinned."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from survey.cloud.stitch import kept_points
from survey.products.coverage import looked_at
from survey.products.frame_file import FrameResult
from survey.products.map_tiles import MapTile
from terrain.map_frame import MapFrame

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TilePoints:
    """Points and pixels of a tile.

    Parameters
    ----------
    tile : MapTile
    bottom, surface : PointCloud
        Stitched and thinned points in the tile, in the order of frame, row and column.
    looked_at : array (n, 2)
        Where pixels look, in the tile and its margin [m, map].
    outcomes : array (n,)
        What became of the bottom there.
    """

    tile: MapTile
    bottom: PointCloud
    surface: PointCloud
    looked_at: FloatArray
    outcomes: NDArray[np.uint8]


def tile_points(
    tile: MapTile, results: Iterable[FrameResult], *, thinning: float, map_frame: MapFrame
) -> TilePoints:
    """Return what the frames hold in a tile.

    Cells of thinning on the border of a tile are filled from its margin, so that every point that
    stays lies in exactly one tile, and is the one that stays when all are thinned together.

    Parameters
    ----------
    tile : MapTile
    results : iterable of FrameResult
        Its frames, in any order.
    thinning : float
        Side of the cells of thinning [m]; the tile's margin is no smaller.
    map_frame : MapFrame
        Where the frames' points lie on the map.
    """
    parts = [_in_reach(tile, result, map_frame) for result in results]
    bottom, surface, places, outcomes = zip(*parts, strict=True)
    return TilePoints(
        tile=tile,
        bottom=_thinned(tile, PointCloud.concatenate(bottom), thinning, map_frame),
        surface=_thinned(tile, PointCloud.concatenate(surface), thinning, map_frame),
        looked_at=np.concatenate(places),
        outcomes=np.concatenate(outcomes),
    )


def _in_reach(
    tile: MapTile, result: FrameResult, map_frame: MapFrame
) -> tuple[PointCloud, PointCloud, FloatArray, NDArray[np.uint8]]:
    places, outcomes = looked_at(result.record)
    places = places + map_frame.origin[:2]
    near = tile.reaches(places)
    bottom, surface = (
        cloud.select(tile.reaches(map_frame.to_map(cloud.position)))
        for cloud in (result.bottom, result.surface)
    )
    return bottom, surface, places[near], outcomes[near]


def _thinned(tile: MapTile, cloud: PointCloud, thinning: float, map_frame: MapFrame) -> PointCloud:
    kept = kept_points(cloud, cell_size=thinning)
    return cloud.select(kept[tile.contains(map_frame.to_map(cloud.position[kept]))])
