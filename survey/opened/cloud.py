"""A cloud of a run as columns, and as an object of open3d or pyvista."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointClass
from survey.errors import UserError
from survey.products.depth_colours import depth_colours
from survey.scenario.faults import did_you_mean
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    import open3d
    import pyvista

FloatArray = NDArray[np.float64]
PLACE = ("x", "y", "z")


@dataclass(frozen=True, kw_only=True, repr=False)
class Cloud:
    """Points with the truth beside them; ``cloud["depth_m"]`` is a column, ``cloud[mask]`` a part.

    Parameters
    ----------
    records : array (n,)
        One record a point, in the columns of the PLY files; docs/files.md has each with its unit.
        ``x``, ``y``, ``z`` are easting, northing and elevation on the map [m].
    map_frame : MapFrame
        Where the local frame lies on the map.
    water_level : float
        In the vertical datum [m].

    Examples
    --------
    >>> points = np.zeros(3, [("x", "f8"), ("y", "f8"), ("z", "f8"), ("depth_m", "f8")])
    >>> points["depth_m"] = 2.0, 7.0, 8.0
    >>> frame = MapFrame(easting=500000.0, northing=6.0e6, epsg=25832, vertical_epsg=5714)
    >>> cloud = Cloud(records=points, map_frame=frame, water_level=0.0)
    >>> cloud[cloud["depth_m"] > 5.0]
    Cloud of 2 points: x, y, z, depth_m
    """

    records: NDArray[np.void]
    map_frame: MapFrame
    water_level: float

    def __len__(self) -> int:
        return len(self.records)

    def __repr__(self) -> str:
        return f"Cloud of {len(self)} points: {', '.join(self.names)}"

    @overload
    def __getitem__(self, which: str) -> NDArray[Any]: ...

    @overload
    def __getitem__(self, which: slice | NDArray[Any]) -> Cloud: ...

    def __getitem__(self, which: str | slice | NDArray[Any]) -> NDArray[Any] | Cloud:
        """Return a column by its name, or the points of a mask, of indices or of a slice."""
        if not isinstance(which, str):
            return replace(self, records=self.records[which])
        if which not in self.names:
            hint = did_you_mean(which, self.names) or f" There are {', '.join(self.names)}."
            raise UserError(f"{which!r}: no such column.{hint}")
        return self.records[which]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns."""
        return self.records.dtype.names or ()

    @property
    def position(self) -> FloatArray:
        """Places (n, 3) in the local frame [m]: add ``map_frame.origin`` for those on the map."""
        return self.map_frame.to_local(np.stack([self.records[axis] for axis in PLACE], axis=1))

    @property
    def error(self) -> FloatArray:
        """Measured less true elevation at the measured place (n,) [m]; nan off the seabed."""
        return np.asarray(self["z"] - self["true_elevation"])

    def of_class(self, *classes: PointClass) -> Cloud:
        """Return the points of some LAS classes."""
        return self[np.isin(self["classification"], classes)]

    def to_pyvista(self) -> pyvista.PolyData:
        """Return the points in the local frame, with every other column as point data."""
        import pyvista

        points = pyvista.PolyData(self.position)
        for name in self._attributes:
            points.point_data[name] = self[name]
        points.set_active_scalars("depth_m")
        return points

    def to_open3d(self) -> open3d.t.geometry.PointCloud:
        """Return the points in the local frame, coloured by depth, every other column with them.

        It is a tensor cloud, which alone can keep columns; ``to_legacy()`` makes a plain one of it.
        """
        import open3d

        tensor: Any = open3d.core.Tensor
        points = open3d.t.geometry.PointCloud(tensor(self.position))
        colours = depth_colours(self.water_level - self["z"])[:, :3] / np.float32(255.0)
        points.point["colors"] = tensor(colours)
        for name in self._attributes:
            points.point[name] = tensor(np.ascontiguousarray(self[name])[:, None])
        return points

    @property
    def _attributes(self) -> Sequence[str]:
        return [name for name in self.names if name not in PLACE]
