"""A cover brought onto the faces of a seabed, which are split where it changes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from terrain.cover import Cover
from terrain.seabed import Seabed
from terrain.substrate import UNLABELLED

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]

MOST_FACES = 20_000_000


def covered(seabed: Seabed, cover: Cover) -> Seabed:
    """Return the seabed with every face made of what the cover shows at its centre.

    Faces over which the cover changes are split at the middles of their edges until they are no
    wider than a cell; the shape stays. Where the cover says nothing the seabed stays as it is.

    Raises
    ------
    ValueError
        When that makes more than 20 million faces.
    """
    fine = _split(seabed, cover)
    row, col = _cells_of(fine, cover, np.asarray(fine.mesh.triangles_center))
    kind = _kind_at(cover, row, col)
    shown = kind >= 0
    labelled = shown & (cover.code[kind] != UNLABELLED)
    used = {code: cover.names[code] for code in np.unique(cover.code[kind[labelled]]).tolist()}
    return replace(
        fine,
        reflectance=np.where(shown, cover.reflectance[kind], fine.reflectance),
        substrate=np.where(labelled, cover.code[kind], fine.substrate),
        substrate_names={**fine.substrate_names, **used},
        source=f"{fine.source} {cover.sentence}",
    )


def _cells_of(seabed: Seabed, cover: Cover, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return row and column, 0 in the middle of the first cell, of local places (..., 3)."""
    on_map = seabed.map_frame.to_map(places)
    return cover.cells.row_col(on_map[..., 0], on_map[..., 1])


def _kind_at(cover: Cover, row: FloatArray, col: FloatArray) -> IntArray:
    """Return the kinds of bottom at rows and columns, -1 outside."""
    rows, cols = cover.kind.shape
    i, j = _rounded(row, -1, rows), _rounded(col, -1, cols)
    inside = (i >= 0) & (i < rows) & (j >= 0) & (j < cols)
    return np.where(inside, cover.kind[i % rows, j % cols], np.int32(-1))


def _rounded(place: FloatArray, lowest: int, highest: int) -> IntArray:
    return np.clip(np.rint(place), lowest, highest).astype(np.int32)


def _split(seabed: Seabed, cover: Cover) -> Seabed:
    """Return the seabed with faces split where the cover changes; whole faces come first."""
    import trimesh

    changes = _changes(cover.kind)
    vertices, faces = np.asarray(seabed.mesh.vertices), np.asarray(seabed.mesh.faces)
    parent = np.arange(len(faces))
    while True:
        row, col = _cells_of(seabed, cover, vertices[faces])
        wide = np.maximum(np.ptp(row, axis=1), np.ptp(col, axis=1)) > 1.0
        several = np.flatnonzero(wide & _is_mixed(changes, row, col))
        if several.size == 0:
            break
        if len(faces) + 3 * several.size > MOST_FACES:
            raise ValueError(
                f"map: its boundaries cut the seabed into more than {MOST_FACES:,} faces. coarsen "
                "the map or take a smaller margin_m"
            )
        vertices, faces = trimesh.remesh.subdivide(  # type: ignore[no-untyped-call]
            vertices, faces, face_index=several
        )
        parent = np.concatenate([np.delete(parent, several), np.repeat(parent[several], 4)])
    return replace(
        seabed,
        mesh=trimesh.Trimesh(vertices, faces, process=False),
        reflectance=seabed.reflectance[parent],
        is_object=seabed.is_object[parent],
        substrate=seabed.substrate[parent],
    )


def _changes(kind: IntArray) -> tuple[IntArray, IntArray]:
    """Return how often the cover changes along its rows and columns up to each cell, summed.

    A rim of cells that say nothing is put around the cover first.
    """
    rimmed = np.pad(kind, 1, constant_values=-1)
    along_row = np.zeros((rimmed.shape[0] + 1, rimmed.shape[1]), dtype=np.int32)
    along_col = np.zeros((rimmed.shape[0], rimmed.shape[1] + 1), dtype=np.int32)
    along_row[1:, 1:] = np.cumsum(np.cumsum(np.diff(rimmed, axis=1) != 0, axis=0), axis=1)
    along_col[1:, 1:] = np.cumsum(np.cumsum(np.diff(rimmed, axis=0) != 0, axis=0), axis=1)
    return along_row, along_col


def _is_mixed(
    changes: tuple[IntArray, IntArray], row: FloatArray, col: FloatArray
) -> NDArray[np.bool_]:
    """Tell over which faces (n,) the cover changes within the cells that bound their corners."""
    along_row, along_col = changes
    rows, cols = along_col.shape[0], along_row.shape[1]
    top, bottom = (_rounded(end(row, axis=1) + 1, 0, rows - 1) for end in (np.min, np.max))
    left, right = (_rounded(end(col, axis=1) + 1, 0, cols - 1) for end in (np.min, np.max))
    in_rows = _box_sum(along_row, top, bottom + 1, left, right)
    return (in_rows + _box_sum(along_col, top, bottom, left, right + 1)) > 0


def _box_sum(
    sums: IntArray, top: IntArray, bottom: IntArray, left: IntArray, right: IntArray
) -> IntArray:
    return sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left]
