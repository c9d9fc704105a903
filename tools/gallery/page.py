"""docs/gallery.md: what every scenario shows, what to expect, its picture and its figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from survey import load_scenario
from survey.scenario.gallery import gallery, shows
from tools.gallery.pictures import kind

HEAD = """# Gallery

Every scenario that comes with bathyflash, flown whole. `bathyflash scenarios` lists them,
`bathyflash run NAME -o runs/NAME` flies one. The words are those at the head of each scenario's
file; `make gallery` makes pictures and figures from the runs.

Errors are measured less true elevation of all bottom points; false are those more than 1 m off.
TVU and THU are the shares of points whose stated uncertainty of 95 % holds.
"""
NOT_FLOWN = "*Not flown for this page yet; `make gallery` does it.*"
COLUMNS = ("scenario", "shows", "bottom points", "false", "bias", "95 % within", "TVU", "THU")


def page(runs: Mapping[str, Mapping[str, Any]]) -> str:
    """Return the page of metrics by the names of their scenarios; some may be missing."""
    table = [COLUMNS, ("---",) * len(COLUMNS), *(row(name, runs.get(name)) for name in gallery())]
    lines = ["| " + " | ".join(cells) + " |" for cells in table]
    return "\n".join([HEAD, *lines, "", *(part(name, runs.get(name)) for name in gallery())])


def row(name: str, found: Mapping[str, Any] | None) -> tuple[str, ...]:
    """Return a scenario's line in the table."""
    first = f"[{name}](#{name})", shows(gallery()[name]).rstrip(".")
    if found is None:
        return (*first, *[""] * (len(COLUMNS) - 2))
    return (
        *first,
        f"{found['points_bottom']:,}",
        f"{found['false_bottoms']:,}",
        metres(found["bias_m"], "+.3f"),
        metres(found["p95_abs_error_m"], ".3f"),
        share(found["tvu_coverage"]),
        share(found["thu_coverage"]),
    )


def part(name: str, found: Mapping[str, Any] | None) -> str:
    """Return what the page says of one scenario."""
    mission = load_scenario(name).mission
    words = f"""## {name}

**{mission.title}.** {mission.description.strip()}

**Expect:** {mission.expect.strip()}
"""
    if found is None:
        return f"{words}\n{NOT_FLOWN}\n"
    return f"""{words}
![{mission.title}](gallery/{name}.png)

*{kind(name).caption}*

**Measured:** {measured(found)}
"""


def measured(found: Mapping[str, Any]) -> str:
    """Return what a run measured, in a sentence or two."""
    flown = f"{found['frames']} frames gave {found['points_surface']:,} points of the sea surface"
    if not found["points_bottom"]:
        return f"{flown} and no bottom, {found['false_bottoms']} false ones."
    return (
        f"{flown}, {found['points_bottom']:,} of the bottom, {found['false_bottoms']:,} of them "
        f"false. Bias {metres(found['bias_m'], '+.3f')}, 95 % within "
        f"{metres(found['p95_abs_error_m'], '.3f')}; TVU, in the median "
        f"{metres(found['tvu_median_m'], '.2f')}, holds for {share(found['tvu_coverage'])}, THU, "
        f"{metres(found['thu_median_m'], '.2f')}, for {share(found['thu_coverage'])}. "
        f"{share(found['coverage_fraction'])} of the wet area was seen."
    )


def metres(value: float | None, form: str) -> str:
    """Return a length in metres."""
    return "none" if value is None else f"{value:{form}} m"


def share(value: float | None) -> str:
    """Return a share in per cent."""
    return "none" if value is None else f"{100.0 * value:.1f} %"
