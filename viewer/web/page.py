"""One HTML file that shows a finished run in any browser, without a network."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping
from hashlib import sha256
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

from survey.cloud.points import PointCloud
from viewer.attributes import categories_of, depth_attribute, frame_attribute
from viewer.run_folder import FlownSurvey
from viewer.scene import median_spacing
from viewer.view import exaggeration, long_axis
from viewer.web.attributes import as_json, measures_of
from viewer.web.flight import flight_of
from viewer.web.left_out import left_out
from viewer.web.points import Chosen, packed_bottom, packed_cloud

FloatArray = NDArray[np.float64]
SCRIPTS = (
    *("decode.js", "colours.js", "clouds.js", "flight.js", "scene.js", "overlay.js"),
    *("plot.js", "waveform.js", "controls.js", "keys.js", "main.js"),
)
ASSETS = files("viewer.web") / "assets"
VENDOR = files("viewer.web") / "vendor"


def page_contents(
    flown: FlownSurvey,
    chosen: Mapping[str, Chosen],
    *,
    waveforms: Mapping[str, Any] | None = None,
    seabed: Mapping[str, Any] | None = None,
    substrates: Mapping[int, str] | None = None,
) -> dict[str, Any]:
    """Return all that the page shows, ready for JSON.

    Parameters
    ----------
    flown : FlownSurvey
    chosen : mapping of str to Chosen
        Its points, from `viewer.web.points.chosen_points`.
    waveforms, seabed : mapping, optional
        From `viewer.web.waveforms.waveforms` and `viewer.web.seabed.true_seabed`; the page says
        when they are missing.
    substrates : mapping, optional
        Names of the codes of what the bottom is made of; numbers stand for those without.
    """
    bottom = chosen["bottom"].cloud
    columns = int(max(kind.cloud.column.max(initial=0) for kind in chosen.values())) + 1
    axis = long_axis(bottom.position[:, :2], bottom.position[:, 2])
    return {
        "title": flown.title,
        "description": flown.description,
        "waterLevel": flown.water_level,
        "origin": [flown.map_frame.easting, flown.map_frame.northing],
        "crs": flown.map_frame.crs.name,
        "axis": axis.tolist(),
        "exaggeration": _exaggeration(bottom.position, axis, flown.water_level),
        "spacing": median_spacing(bottom.position[:, :2]),
        "attributes": _attributes(flown, bottom, substrates or {}),
        "clouds": {
            "bottom": packed_bottom(bottom, columns_of_camera=columns),
            **{
                name: packed_cloud(chosen[name].cloud, columns_of_camera=columns)
                for name in ("other", "surface")
            },
        },
        "flight": flight_of(flown),
        "waveforms": waveforms,
        "seabed": seabed,
        "leftOut": left_out(chosen, waveforms=waveforms, seabed=seabed),
    }


def html(contents: Mapping[str, Any]) -> str:
    """Return the page with its contents: one document whose policy forbids every request."""
    script, style = _script(), _text(ASSETS / "page.css")
    data = json.dumps(contents, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
    parts = {
        "@POLICY@": f"default-src 'none'; img-src data:; script-src {_digest(script)}; "
        f"style-src {_digest(style)}; base-uri 'none'; form-action 'none'",
        "@TITLE@": escape(str(contents["title"])),
        "@STYLE@": style,
        "@DATA@": data,
        "@SCRIPT@": script,
    }
    return _filled(_text(ASSETS / "page.html"), parts)


def _filled(template: str, parts: Mapping[str, str]) -> str:
    """Return a template with each of its marks replaced once; what is filled in is not looked at.

    Examples
    --------
    >>> _filled("<b>@A@</b>@B@", {"@A@": "@B@", "@B@": "x"})
    '<b>@B@</b>x'
    """
    pieces = []
    for mark, text in parts.items():
        before, _, template = template.partition(mark)
        pieces += [before, text]
    return "".join([*pieces, template])


def _script() -> str:
    """Return three.js with its licence, then ours in one scope."""
    licence = _text(VENDOR / "LICENSE-three.txt")
    ours = "\n".join(_text(ASSETS / name) for name in SCRIPTS)
    three = _text(VENDOR / "three.min.js")
    return f'/*\n{licence}*/\n{three}\n(() => {{\n"use strict";\n{ours}\n}})();\n'


def _digest(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def _text(path: Any) -> str:
    return str(path.read_text(encoding="utf-8"))


def _attributes(
    flown: FlownSurvey, bottom: PointCloud, substrates: Mapping[int, str]
) -> list[dict[str, Any]]:
    """Return what points can be coloured by, in the order of the keys 1 to 9 and 0."""
    _, measures = measures_of(bottom)
    *kinds, line = map(as_json, categories_of(bottom, substrates))
    depth = as_json(depth_attribute(flown.water_level - bottom.position[:, 2]))
    return [depth, *measures, *kinds, as_json(frame_attribute(flown.frame)), line]


def _exaggeration(places: FloatArray, axis: FloatArray, water_level: float) -> float:
    """Return the factor for heights with which the page opens, that of the pictures."""
    low, high = np.percentile(places[:, 2], [0.5, 99.5])
    return exaggeration(max(high, water_level) - low, float(np.ptp(places[:, :2] @ axis)))
