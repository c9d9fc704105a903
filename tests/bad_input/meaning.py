"""What an input that was accepted must still mean."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from survey.scenario import components
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario
from terrain.extent import HIGHEST

MEANS = {
    **dict.fromkeys(("mesh_ply", "mesh_ply_binary", "mesh_obj", "mesh_stl", "mesh_off"), "seabed"),
    **dict.fromkeys(("mesh_glb", "raster", "cover", "las", "laz"), "seabed"),
    **dict.fromkeys(("track_csv", "track_cblue", "track_sbet", "area"), "flight"),
    **dict.fromkeys(("phase", "cast"), "water"),
    "scenario": "scenario",
}
"""By which of the functions an accepted input of each kind is asked."""
PARTS = (
    *(components.camera, components.receiver, components.detector, components.water),
    *(components.sea_surface, components.transport_settings, components.navigation),
)


def scenario(path: Path) -> list[str]:
    """Every part can be built of finite numbers, and the resolved form reads back the same."""
    found = load_scenario(path)
    beside = path.with_name("resolved.toml")
    beside.write_text(found.to_toml(), encoding="utf-8")
    again = load_scenario(beside)
    wrong = [] if again.to_toml() == found.to_toml() else ["the resolved form reads back otherwise"]
    wrong += [f"{place} = {value}" for place, value in _numbers(found.given) if not _finite(value)]
    for part in PARTS:
        part(found)
    if not math.isfinite(components.background_radiance(found)):
        wrong.append("background light that is not finite")
    return wrong + flight(path)


def flight(path: Path) -> list[str]:
    """Every flash has a finite pose above the water."""
    found = load_scenario(path)
    poses = [frame.pose for frame in components.frames(found)]
    places = np.array([[*pose.position, pose.roll, pose.pitch, pose.heading] for pose in poses])
    wrong = [] if len(poses) else ["no flash"]
    if not np.isfinite(places).all():
        wrong.append("a pose that is not finite")
    elif (places[:, 2] <= found.surface.water_level_m).any() or (places[:, 2] > 1e5).any():
        wrong.append(f"flashes from {places[:, 2].min():g} to {places[:, 2].max():g} m")
    return wrong


def seabed(path: Path) -> list[str]:
    """Vertices are finite and on the earth, faces have three vertices that exist."""
    found = components.seabed(load_scenario(path))
    vertices, faces = found.mesh.vertices, found.mesh.faces
    wrong = []
    if not np.isfinite(vertices).all():
        wrong.append("a vertex that is not finite")
    elif np.abs(vertices[:, 2]).max() > HIGHEST:
        wrong.append(f"elevations to {np.abs(vertices[:, 2]).max():g} m")
    if not len(faces) or faces.min() < 0 or faces.max() >= len(vertices):
        wrong.append("no faces, or faces of vertices there are not")
    if not ((found.reflectance >= 0.0) & (found.reflectance <= 1.0)).all():
        wrong.append("reflectances out of bounds")
    return wrong


def water(path: Path) -> list[str]:
    """Coefficients are finite and the phase functions integrate to one."""
    wrong = []
    for medium in _waters(load_scenario(path)):
        phase = medium.phase_function
        if not (0.0 < medium.absorption < 1e4 and 0.0 < medium.scattering < 1e4):
            wrong.append(f"a = {medium.absorption:g}, b = {medium.scattering:g}")
        if not abs(phase.fraction_within(math.pi) - 1.0) < 1e-6:
            wrong.append(f"a phase function that integrates to {phase.fraction_within(math.pi):g}")
        if not (-1.0 < phase.mean_cosine < 1.0 and np.isfinite(phase.sampler_table()).all()):
            wrong.append(f"a mean cosine of {phase.mean_cosine:g}")
    return wrong


def score(path: Path) -> list[str]:
    """Every number of a score is finite or missing."""
    numbers = _numbers(json.loads(path.read_text(encoding="utf-8")))
    return [f"{place} = {value}" for place, value in numbers if not _finite(value)]


def _waters(found: Scenario) -> list[Any]:
    return [layer.water for layer in components.water(found).layers]


def _finite(value: Any) -> bool:
    return not isinstance(value, float) or math.isfinite(value)


def _numbers(value: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _numbers(inner, f"{place}.{key}")
    elif isinstance(value, list):
        for number, inner in enumerate(value):
            yield from _numbers(inner, f"{place}.{number}")
    else:
        yield place, value
