"""What stands in the scene beside points: meshes, flight, footprints, marks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from terrain.seabed import Seabed
from viewer import scene
from viewer.desktop.colouring import Colouring, painted
from viewer.desktop.content import Content
from viewer.desktop.feeding import COLOUR, coloured, feed
from viewer.desktop.levels import LeveledPlaces
from viewer.desktop.state import Layer, ViewState
from viewer.labels import FLIGHT, INK

if TYPE_CHECKING:
    import pyvista

FloatArray = NDArray[np.float64]
Colours = NDArray[np.uint8]
MOST_FACES = 150_000
MOST_CELLS = 60_000
FEW = 20_000
AROUND = 20.0
"""The true seabed is drawn so far around what was looked at [m]."""

COLOURED_BY = 1_000_000
"""So many points, first in order, give the mesh its colours."""

BEAM = "#2ca02c"
MARK = "#d5008f"
SAND = (185, 168, 136)
AIRCRAFT_PIXELS = 60.0
LIFTED = (Layer.FOOTPRINTS, "footprint", "marks", "profile")
LIFT_PIXELS = 30.0
"""So far these lie in front of the bottom, towards the eye, lest it swallow them."""


class Scenery:
    """Everything but points; each thing is made when it is first shown.

    Parameters
    ----------
    plotter : pyvista.Plotter
    content : Content
    colouring : Colouring
    bottom : LeveledPlaces
        Of the bottom's points: they colour the mesh.
    """

    def __init__(
        self,
        plotter: pyvista.Plotter,
        content: Content,
        colouring: Colouring,
        bottom: LeveledPlaces,
    ) -> None:
        self._plotter, self._content, self._colouring = plotter, content, colouring
        self._bottom = bottom
        self._actors: dict[str, list[Any]] = {}
        self._stretched: list[Any] = []
        self._meshes: dict[Layer, tuple[Any, Any]] = {}
        self._flown: tuple[Any, ...] = ()
        self._marked: tuple[Any, ...] = ()
        self._nearest: NDArray[np.intp] = np.zeros(0, dtype=np.intp)

    def show(self, state: ViewState) -> None:
        """Switch things on and off, and stretch their heights."""
        makers: dict[Layer, Callable[[], list[Any]]] = {
            Layer.MESH: self._mesh,
            Layer.SEABED: self._seabed,
            Layer.FLIGHT: self._flight,
            Layer.FOOTPRINTS: self._footprints,
        }
        for layer, make in makers.items():
            if layer in state.layers and layer not in self._actors:
                self._actors[layer] = make()
            for actor in self._actors.get(layer, []):
                actor.visibility = layer in state.layers
        lift = LIFT_PIXELS * state.orbit.metres_per_pixel * state.orbit.view((1, 1)).towards
        for name in LIFTED:
            for actor in self._actors.get(name, []):
                actor.SetPosition(*lift)
        for actor in self._stretched:
            actor.SetOrigin(0.0, 0.0, self._content.flown.water_level)
            actor.SetScale(1.0, 1.0, state.exaggeration)

    def paint(self, attribute: str) -> None:
        """Colour the mesh by an attribute, the true seabed by depth or like sand."""
        if Layer.MESH in self._meshes:
            actor, data = self._meshes[Layer.MESH]
            which = self._bottom.order[self._nearest]
            colours = self._colouring.colours(attribute, Layer.BOTTOM, which)
            feed(actor, coloured(data, colours))
        if Layer.SEABED in self._meshes:
            actor, data = self._meshes[Layer.SEABED]
            depth = np.asarray(data[scene.DEPTH])
            feed(actor, coloured(data, self._seabed_colours(attribute, depth)))

    def fly(
        self,
        state: ViewState,
        *,
        position: FloatArray,
        heading: float,
        corners: FloatArray,
    ) -> None:
        """Put aircraft, light and footprint of a flash where they are.

        Parameters
        ----------
        state : ViewState
        position : array (3,)
            Of the sensor [m].
        heading : float
            [rad]
        corners : array (4, 3)
            Of the footprint, to scale [m].
        """
        shown = Layer.LIGHT in state.layers
        self._put_aircraft(state, position=position, heading=heading, shown=shown)
        flown = (shown, state.exaggeration, position.tobytes(), corners.tobytes())
        if self._flown == flown:
            return
        self._flown = flown
        on_bottom = scene.stretched(
            corners,
            water_level=self._content.flown.water_level,
            exaggeration=state.exaggeration,
        )
        cone = scene.light_cone(position, on_bottom)
        outline = scene.outlines(on_bottom[None])
        self._put("cone", cone, shown, color=BEAM, opacity=0.12)
        self._put("edges", cone.extract_all_edges(), shown, color=BEAM, line_width=1.5)
        self._put("footprint", outline, shown, color=BEAM, line_width=4.0)

    def mark(self, state: ViewState) -> None:
        """Show where points are picked, and the line of the profile."""
        marked = (state.picked, state.ends, state.exaggeration)
        if self._marked == marked:
            return
        self._marked = marked
        picked = [state.picked.place] if state.picked else []
        places = np.array([*picked, *state.ends], np.float64).reshape(-1, 3)
        drawn = scene.stretched(
            places,
            water_level=self._content.flown.water_level,
            exaggeration=state.exaggeration,
        )
        some = len(drawn) > 0
        shown = drawn if some else np.zeros((1, 3))
        look = {"color": MARK, "point_size": 13.0, "render_points_as_spheres": True}
        self._put("marks", _data(shown), some, style="points", **look)
        both = len(state.ends) == 2
        line = _segment(drawn[-2:] if both else np.zeros((2, 3)))
        self._put("profile", line, both, color=MARK, line_width=3.0)

    def _put_aircraft(
        self, state: ViewState, *, position: FloatArray, heading: float, shown: bool
    ) -> None:
        """Draw the aircraft in the same size however near the eye is."""
        if "aircraft" not in self._actors:
            plane = scene.aircraft(np.zeros(3), 0.0, length=1.0)
            self._actors["aircraft"] = [self._add(plane, color=INK, lighting=False)]
        (actor,) = self._actors["aircraft"]
        actor.visibility = shown
        actor.SetScale(AIRCRAFT_PIXELS * state.orbit.metres_per_pixel)
        actor.SetOrientation(0.0, 0.0, -np.degrees(heading))
        actor.SetPosition(*position)

    def _put(self, name: str, data: Any, shown: bool, **look: Any) -> None:
        if name not in self._actors:
            self._actors[name] = [self._add(data, lighting=False, **look)]
        (actor,) = self._actors[name]
        feed(actor, data)
        actor.visibility = shown

    def _add(self, data: Any, **look: Any) -> Any:
        return self._plotter.add_mesh(
            data, reset_camera=False, render=False, pickable=False, **look
        )

    def _mesh(self) -> list[Any]:
        from scipy.spatial import cKDTree

        content = self._content
        extent = np.ptp(content.bottom.position[:, :2], axis=0)
        least = float(np.sqrt(np.prod(np.maximum(extent, 1.0)) / MOST_CELLS))
        data = scene.bottom_surface(
            content.bottom,
            content.flown.map_frame,
            water_level=content.flown.water_level,
            exaggeration=1.0,
            cell_size=max(scene.CELLS_PER_SPACING * content.spacing, least),
        )
        few = self._bottom.place[:COLOURED_BY, :2]
        _, found = cKDTree(few).query(np.asarray(data.points)[:, :2])
        self._nearest = np.asarray(found, dtype=np.intp)
        return [self._coloured(Layer.MESH, data)]

    def _seabed(self) -> list[Any]:
        seabed = self._content.seabed
        if seabed is None:
            return []
        level = {"water_level": self._content.flown.water_level, "exaggeration": 1.0}
        mesh = seabed.mesh
        if len(mesh.faces) > MOST_FACES:
            import trimesh

            mesh = trimesh.Trimesh(*self._sampled(seabed))
        shown = faces_around(mesh.triangles[:, :, :2], self._seen(), AROUND)
        part: Any = mesh.submesh([shown], append=True)
        return [self._coloured(Layer.SEABED, scene.true_seabed(part, **level))]

    def _seen(self) -> FloatArray:
        """Return few places (n, 2) that show where the survey looked [m]."""
        clouds = (self._content.bottom, self._content.clouds[Layer.OTHER])
        return np.vstack([cloud.position[:: len(cloud) // FEW + 1, :2] for cloud in clouds])

    def _sampled(self, seabed: Seabed) -> tuple[FloatArray, NDArray[np.intp]]:
        place = self._content.bottom.position
        low, high = place[:, :2].min(axis=0), place[:, :2].max(axis=0)
        cell = scene.cell_for(high - low)
        x, y = (np.arange(low[i], high[i] + cell, cell) for i in range(2))
        return grid_mesh(x, y, seabed.elevation_at)

    def _coloured(self, layer: Layer, data: pyvista.PolyData) -> Any:
        shaded = data.compute_normals(cell_normals=False, split_vertices=False)
        shaded = coloured(shaded, np.zeros((shaded.n_points, 3), np.uint8))
        actor = self._add(shaded, scalars=COLOUR, rgb=True, ambient=0.25)
        actor.prop.interpolation = "phong"
        self._stretched.append(actor)
        self._meshes[layer] = (actor, shaded)
        return actor

    def _seabed_colours(self, attribute: str, depth: FloatArray) -> Colours:
        if attribute != "depth":
            return np.tile(np.array(SAND, np.uint8), (len(depth), 1))
        return painted(self._colouring.attribute("depth"), depth)

    def _flight(self) -> list[Any]:
        flashes = self._content.flashes
        lines = scene.flight_lines(flashes.position, flashes.line)
        places = _data(flashes.position)
        return [
            self._add(lines, color=FLIGHT, line_width=2.5, lighting=False),
            self._add(places, color=FLIGHT, style="points", point_size=6.0, lighting=False),
        ]

    def _footprints(self) -> list[Any]:
        rings = scene.outlines(self._content.flashes.corners)
        actor = self._add(rings, color=BEAM, line_width=1.0, lighting=False)
        self._stretched.append(actor)
        return [actor]


def faces_around(faces: FloatArray, places: FloatArray, reach: float) -> NDArray[np.intp]:
    """Return the numbers of the faces (n, 3, 2) whose middle has a place (m, 2) within reach [m].

    A face wider than the reach is taken if it may lie under a place.

    Examples
    --------
    >>> small = np.array([[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]])
    >>> faces_around(np.stack([small, small + 9.0, 99.0 * small]), np.array([[0.5, 0.5]]), 1.0)
    array([0, 2])
    """
    from scipy.spatial import cKDTree

    low, high = faces.min(axis=1), faces.max(axis=1)
    distance, _ = cKDTree(places).query(faces.mean(axis=1), distance_upper_bound=reach)
    apart = (low > places.max(axis=0)) | (high < places.min(axis=0))
    wide = (high - low).max(axis=1) > reach
    return np.flatnonzero(np.isfinite(distance) | (wide & ~apart.any(axis=1)))


def grid_mesh(
    x: FloatArray, y: FloatArray, elevation_at: Callable[..., FloatArray]
) -> tuple[FloatArray, NDArray[np.intp]]:
    """Return vertices (n, 3) and triangles of a surface sampled on a grid; gaps stay gaps."""
    on_x, on_y = np.meshgrid(x, y)
    vertices = np.column_stack([on_x.ravel(), on_y.ravel(), elevation_at(on_x, on_y).ravel()])
    number = np.arange(len(vertices)).reshape(on_x.shape)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    faces = np.vstack([np.stack(each, axis=-1).reshape(-1, 3) for each in ((a, b, c), (a, c, d))])
    known = np.isfinite(vertices[:, 2])
    return np.nan_to_num(vertices), faces[known[faces].all(axis=1)]


def _data(places: FloatArray) -> Any:
    import pyvista

    return pyvista.PolyData(np.asarray(places, np.float64))


def _segment(ends: FloatArray) -> Any:
    import pyvista

    return pyvista.PolyData(ends, lines=[2, 0, 1])
