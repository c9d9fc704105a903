"""The seabed: a mesh, how bright it is, and where on the map it lies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from terrain.coverage import CoverageError, uncovered
from terrain.map_frame import MapFrame
from terrain.raycast import SeabedGrid, build_grid, cast_rays
from terrain.substrate import UNLABELLED, Substrate

if TYPE_CHECKING:
    import trimesh

__all__ = ["CoverageError", "Seabed", "uniform_seabed"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Seabed:
    """A triangle mesh with a diffuse reflectance on every face.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        Local coordinates [m], faces counter-clockwise seen from above or from outside.
    reflectance : array (faces,)
        Fraction of the light that a face sends back, 0 to 1.
    is_object : array (faces,) of bool
        True for what stands on the seabed: a wreck, a boulder.
    map_frame : MapFrame
        Where the local frame lies on the map.
    source : str
        A sentence: where the shape comes from.
    substrate : array (faces,) of uint8, optional
        Code of what a face is made of; without it no face has a label.
    substrate_names : mapping
        Name of every code that is in use.

    Raises
    ------
    ValueError
        When an array is not one per face, a reflectance is outside 0 to 1, or the mesh has no
        faces, vertices that are not finite or faces without area.
    """

    mesh: trimesh.Trimesh
    reflectance: FloatArray
    is_object: NDArray[np.bool_]
    map_frame: MapFrame
    source: str
    substrate: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, dtype=np.uint8))
    substrate_names: Mapping[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        faults = []
        faces = len(self.mesh.faces)
        if len(self.substrate) == 0:
            unlabelled = np.full(faces, UNLABELLED, dtype=np.uint8)
            object.__setattr__(self, "substrate", unlabelled)
        for name in ("reflectance", "is_object", "substrate"):
            if np.shape(getattr(self, name)) != (faces,):
                faults.append(f"seabed: {name}: {np.shape(getattr(self, name))} for {faces} faces")
        if not np.all((self.reflectance >= 0.0) & (self.reflectance <= 1.0)):
            faults.append("seabed: reflectance: must lie between 0 and 1")
        if faces == 0 or not np.isfinite(self.mesh.vertices).all():
            faults.append("seabed: mesh: needs at least one face and finite vertices")
        elif self.mesh.area_faces.min() <= 0.0:
            face = int(self.mesh.area_faces.argmin())
            faults.append(f"seabed: mesh: face {face} has no area. remove it")
        if faults:
            raise ValueError("\n".join(faults))

    @cached_property
    def grid(self) -> SeabedGrid:
        """The mesh as the ray kernels take it."""
        return build_grid(self.mesh)

    def elevation_at(self, x: ArrayLike, y: ArrayLike) -> FloatArray:
        """Return the elevation of the topmost face at local places; nan where there is none."""
        return self.topmost_at(x, y)[0]

    def topmost_at(self, x: ArrayLike, y: ArrayLike) -> tuple[FloatArray, NDArray[np.int64]]:
        """Return elevation and number of the topmost face at local places; nan and -1 without."""
        x, y = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        top = self.grid.z_high + 1.0
        origins = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, top)])
        t, face = cast_rays(self.grid, origins, np.array([0.0, 0.0, -1.0]))
        elevation = np.where(np.isfinite(t), top - t, np.nan)
        return elevation.reshape(x.shape), face.reshape(x.shape)

    def require_coverage(
        self, outlines: Sequence[FloatArray], *, label: str = "flight", spacing: float = 1.0
    ) -> None:
        """Refuse footprints that reach beyond the seabed or over a gap in it.

        Parameters
        ----------
        outlines : sequence of array (corners, 2)
            Polygons in the local frame [m].
        label : str
            What the outlines belong to, for the message.
        spacing : float
            Distance of the points at which coverage is looked up [m]; narrower gaps may pass.

        Raises
        ------
        CoverageError
            Naming the uncovered extent on the map, its area and its share.
        """
        gap = uncovered(self.elevation_at, outlines, spacing=spacing)
        if gap is not None:
            raise CoverageError(gap.message(self.map_frame, label))

    def painted(self, faces: Any, substrate: Substrate) -> Seabed:
        """Return the seabed with some faces, a mask, a slice or indices, made of a substrate."""
        reflectance, codes = self.reflectance.copy(), self.substrate.copy()
        reflectance[faces], codes[faces] = substrate.reflectance, substrate.code
        names = dict(self.substrate_names)
        if substrate.code != UNLABELLED:
            names[substrate.code] = substrate.name
        return replace(self, reflectance=reflectance, substrate=codes, substrate_names=names)

    def with_object(self, mesh: trimesh.Trimesh, *, reflectance: float, source: str) -> Seabed:
        """Return the seabed with a body standing on it, in local coordinates [m].

        Its faces come last and have no label.

        Raises
        ------
        ValueError
            As the constructor; the seabed under the body stays as it is.
        """
        import trimesh

        faces = len(mesh.faces)
        return replace(
            self,
            mesh=trimesh.Trimesh(
                np.concatenate([self.mesh.vertices, mesh.vertices]),
                np.concatenate([self.mesh.faces, mesh.faces + len(self.mesh.vertices)]),
                process=False,
            ),
            reflectance=np.concatenate([self.reflectance, np.full(faces, reflectance)]),
            is_object=np.concatenate([self.is_object, np.ones(faces, dtype=bool)]),
            substrate=np.concatenate([self.substrate, np.full(faces, UNLABELLED, np.uint8)]),
            source=f"{self.source} {source}",
        )


def uniform_seabed(
    mesh: trimesh.Trimesh, *, reflectance: float, map_frame: MapFrame, source: str
) -> Seabed:
    """Return a seabed of one reflectance without objects."""
    faces = len(mesh.faces)
    return Seabed(
        mesh=mesh,
        reflectance=np.full(faces, float(reflectance)),
        is_object=np.zeros(faces, dtype=bool),
        map_frame=map_frame,
        source=source,
    )
