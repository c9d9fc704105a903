"""One picture of a finished run: the stitched bathymetry, the sea surface and the flight."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.products.depth_colours import COLOURS, LAND, depth_range
from survey.products.writing import write_whole
from viewer import scene
from viewer.labels import FLIGHT, INK, SEA, Label, draw_labels, round_length
from viewer.rendering import require_rendering
from viewer.run_folder import FlownSurvey, read_run
from viewer.view import View, exaggeration, long_axis, oblique_view

if TYPE_CHECKING:
    import pyvista

FloatArray = NDArray[np.float64]
SIZE = (1600, 1000)
MARGINS = (70, 250, 130, 110)
SURFACE_POINTS = 6_000
CONTOUR_LIFT = 3.0
"""Pixels by which contours lie in front of the bottom, lest it swallow them."""

KEY = (-0.55, 0.25, 0.8)
"""Light from the left, a little behind the eye and above: right, towards the eye, up."""


def screenshot(run: Path, file: Path, *, caption: str | None = None) -> None:
    """Draw a finished run off screen as a PNG of 1600 x 1000 pixels.

    Heights and depths of seabed, land and sea surface are stretched by a factor that the caption
    states; the flight lines stand at their true height above the water.

    Parameters
    ----------
    run : Path
        Run folder; scenario, clouds and trajectory are read.
    file : Path
        PNG to write.
    caption : str, optional
        Text under the picture; the scenario's description if not given.

    Raises
    ------
    FileNotFoundError
        If the run folder lacks a file.
    ValueError
        If a file is broken or holds no bottom point.
    RuntimeError
        If this machine cannot render; the text has the line that installs what is missing.
    """
    flown = read_run(run)
    require_rendering()
    write_whole(file, render(flown, caption=flown.description if caption is None else caption))


def render(flown: FlownSurvey, *, caption: str) -> bytes:
    """Return the picture as PNG. See `screenshot`."""
    solid = scene.solid_positions(flown.bottom)
    axis = long_axis(solid[:, :2], solid[:, 2])
    length = float(np.ptp(solid[:, :2] @ axis))
    low, high = np.percentile(solid[:, 2], [0.5, 99.5])
    factor = exaggeration(max(high, flown.water_level) - low, length)
    bottom = scene.bottom_surface(
        flown.bottom, flown.map_frame, water_level=flown.water_level, exaggeration=factor
    )
    depths = depth_range(bottom[scene.DEPTH])
    bar = round_length(0.3 * length)
    bar_start = _beside(bottom.points, axis, aside=0.06 * length)
    bar_end = bar_start - np.append(bar * axis, 0.0)
    contents = np.vstack([bottom.points, flown.positions, bar_start, bar_end])
    view = oblique_view(contents, axis=axis, size=SIZE, margins=MARGINS)
    return draw_labels(
        _picture(flown, bottom, view, factor=factor, depths=depths),
        view,
        title=flown.title,
        caption=f"{_scales(factor, _contour_step(depths))}\n{caption}",
        depths=depths,
        labels=_labels(flown, view),
        bar_start=bar_start,
        bar_axis=np.append(-axis, 0.0),
        bar_length=bar,
    )


def _scales(factor: float, step: float) -> str:
    lines = f"Depth contours, smoothed, every {step:g} m."
    if factor == 1.0:
        return f"All heights to scale. {lines}"
    return f"Heights of seabed, land and sea are drawn x {factor:g}, the flight to scale. {lines}"


def _picture(
    flown: FlownSurvey,
    bottom: pyvista.PolyData,
    view: View,
    *,
    factor: float,
    depths: tuple[float, float],
) -> NDArray[np.uint8]:
    import pyvista

    plotter = pyvista.Plotter(off_screen=True, window_size=list(view.size), lighting="none")
    plotter.renderer.set_background("white")
    plotter.enable_anti_aliasing("msaa", multi_samples=8)
    _add_light(plotter, view)
    _add_bottom(plotter, bottom, depths)
    contours = scene.depth_contours(
        bottom,
        step=_contour_step(depths),
        water_level=flown.water_level,
        exaggeration=factor,
    )
    _add_contours(plotter, contours, view)
    _add_sea(plotter, flown, factor)
    _add_flight(plotter, flown, view, factor)
    _aim(plotter, view)
    picture = np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8)
    plotter.close()
    return picture


def _add_light(plotter: pyvista.Plotter, view: View) -> None:
    import pyvista

    direction = KEY[0] * view.right + KEY[1] * view.towards + KEY[2] * np.array([0.0, 0.0, 1.0])
    for place, strength in ((direction, 0.75), (view.towards, 0.3)):
        light = pyvista.Light(position=tuple(place), light_type="scene light", intensity=strength)
        plotter.add_light(light)


def _add_bottom(
    plotter: pyvista.Plotter, bottom: pyvista.PolyData, depths: tuple[float, float]
) -> None:
    plotter.add_mesh(
        bottom,
        scalars=scene.DEPTH,
        cmap=COLOURS,
        clim=depths,
        below_color=LAND if depths[0] == 0.0 else None,
        smooth_shading=True,
        ambient=0.35,
        diffuse=0.85,
        show_scalar_bar=False,
    )


def _add_contours(plotter: pyvista.Plotter, contours: pyvista.PolyData, view: View) -> None:
    if contours.n_points == 0:
        return
    contours.points += CONTOUR_LIFT * view.metres_per_pixel * view.towards
    plotter.add_mesh(contours, color="white", opacity=0.6, line_width=1.2, lighting=False)


def _contour_step(depths: tuple[float, float]) -> float:
    """Return the round step that makes about ten contours [m]."""
    return min(
        (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0),
        key=lambda step: abs((depths[1] - depths[0]) / step - 10.0),
    )


def _add_sea(plotter: pyvista.Plotter, flown: FlownSurvey, factor: float) -> None:
    if len(flown.surface) < 3:
        return
    sheet = scene.sea_sheet(flown.surface, water_level=flown.water_level)
    points = scene.surface_points(
        flown.surface,
        water_level=flown.water_level,
        exaggeration=factor,
        at_most=SURFACE_POINTS,
    )
    edges = sheet.extract_feature_edges()
    plotter.add_mesh(sheet, color=SEA, opacity=0.07, lighting=False)
    plotter.add_mesh(edges, color=SEA, line_width=1.5, opacity=0.8, lighting=False)
    plotter.add_mesh(points, color=SEA, point_size=2.0, opacity=0.35, lighting=False)


def _add_flight(plotter: pyvista.Plotter, flown: FlownSurvey, view: View, factor: float) -> None:
    lines = scene.flight_lines(flown.positions, flown.line)
    plotter.add_mesh(lines, color=FLIGHT, line_width=2.5, lighting=False)
    plotter.add_points(flown.positions, color=FLIGHT, point_size=6.0, lighting=False)
    length = 60.0 * view.metres_per_pixel
    shown = _shown_flash(flown)
    corners = scene.footprint(flown.bottom, int(flown.frame[shown]))
    plane = scene.aircraft(flown.positions[shown], float(flown.headings[shown]), length=length)
    plotter.add_mesh(plane, color=INK, lighting=False)
    if len(corners):
        on_bottom = scene.stretched(corners, water_level=flown.water_level, exaggeration=factor)
        cone = scene.light_cone(flown.positions[shown], on_bottom)
        plotter.add_mesh(cone, color="#2ca02c", opacity=0.1, lighting=False)
        plotter.add_mesh(
            cone.extract_all_edges(), color="#2ca02c", line_width=1.5, opacity=0.7, lighting=False
        )


def _shown_flash(flown: FlownSurvey) -> int:
    """Return which flash has its aeroplane drawn: in the middle of the last line."""
    last = np.flatnonzero(flown.line == flown.line.max())
    return int(last[last.size // 2])


def _aim(plotter: pyvista.Plotter, view: View) -> None:
    far = 10.0 * view.metres_per_pixel * view.size[0]
    camera: Any = plotter.camera
    camera.focal_point = tuple(view.centre)
    camera.position = tuple(view.centre + far * view.towards)
    camera.up = tuple(view.up)
    camera.enable_parallel_projection()
    camera.parallel_scale = 0.5 * view.size[1] * view.metres_per_pixel
    plotter.renderer.ResetCameraClippingRange()


def _labels(flown: FlownSurvey, view: View) -> list[Label]:
    height = float(np.median(flown.positions[:, 2])) - flown.water_level
    ends = view.pixels(flown.positions)
    highest = flown.positions[int(np.argmax(ends[:, 1]))]
    labels = [
        Label(
            words=f"flight lines, {height:.0f} m above the water",
            place=highest,
            shift=(0.0, 26.0),
            colour=FLIGHT,
        )
    ]
    if len(flown.surface):
        right = view.pixels(flown.surface.position)[:, 0]
        place = flown.surface.position[int(np.argmax(right))]
        labels.append(Label(words="sea surface", place=place, shift=(10.0, 0.0), colour=SEA))
    return labels


def _beside(places: FloatArray, axis: FloatArray, *, aside: float) -> FloatArray:
    """Return the place beside the near deep corner of the bottom where the scale bar begins."""
    side = np.array([axis[1], -axis[0]])
    along, across = places[:, :2] @ axis, places[:, :2] @ side
    corner = along.max() * axis + (across.max() + aside) * side
    return np.append(corner, places[:, 2].min())
