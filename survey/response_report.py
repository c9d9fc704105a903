"""What `bathyflash response` says: as JSON, as a table, as a picture."""

from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from survey.errors import UserError
from survey.products.writing import write_whole

if TYPE_CHECKING:
    from survey.optics.water import Water
    from survey.transport.response import Response

INDEX = 1.33  # phase and group index, as in [Lisenko2017]; only two_way_10ns depends on it


def water_of(
    *,
    name: str | None,
    absorption: float | None,
    scattering: float | None,
    phase_function: Path | None,
) -> Water:
    """Return a named water, or one of given coefficients [1/m] and phase function (a CSV table).

    Raises
    ------
    UserError
        With every fault of the choice.
    """
    from survey.optics.phase.table import read_phase_function
    from survey.optics.water import PAPER_COEFFICIENTS, Water, petzold_water

    own = (absorption, scattering, phase_function)
    faults = []
    if (name is None) == all(value is None for value in own):
        faults.append("response: give either --water or --a, --b and --phase-function")
    if name is None and any(value is None for value in own):
        faults.append("response: --a, --b and --phase-function go together")
    if name is not None and name not in PAPER_COEFFICIENTS:
        faults.append(f"response: --water {name}: is none of {', '.join(PAPER_COEFFICIENTS)}")
    for option, value in (("--a", absorption), ("--b", scattering)):
        if value is not None and not (np.isfinite(value) and value > 0.0):
            faults.append(f"response: {option} {value:g}: must be above 0")
    if faults:
        raise UserError("\n".join(faults))
    if name is not None:
        return petzold_water(name, refractive_index=INDEX, group_index=INDEX)
    assert absorption is not None
    assert scattering is not None
    assert phase_function is not None
    return Water(
        absorption=absorption,
        scattering=scattering,
        phase_function=read_phase_function(phase_function),
        refractive_index=INDEX,
        group_index=INDEX,
    )


def as_json(found: Response) -> dict[str, Any]:
    """Return the response as plain values with units in the keys."""
    edges = found.bin_edges.tolist()
    return {
        "column": [
            {"from_m": low, "to_m": high, "per_m_sr": value, "sem": sem}
            for low, high, value, sem in zip(
                edges[:-1], edges[1:], found.column.tolist(), found.column_sem.tolist(), strict=True
            )
        ],
        "bottom": {
            "depth_m": found.bottom_depth,
            "two_way": found.two_way.value,
            "sem": found.two_way.sem,
            "two_way_10ns": found.two_way_10ns.value,
            "two_way_10ns_sem": found.two_way_10ns.sem,
            "mean_excess_path_m": found.mean_excess_path,
            "blur_radius_m": found.blur_radius,
        },
    }


def as_text(found: Response) -> str:
    """Return the response as a table for people."""
    lines = [
        f"bottom at {found.bottom_depth:g} m",
        f"  two-way transmission          {found.two_way.value:.4e} +- {found.two_way.sem:.1e}",
        f"  within 10 ns of the echo      {found.two_way_10ns.value:.4e}",
        f"  mean excess path (two-way)    {found.mean_excess_path:.3f} m",
        f"  blur radius (half the light)  {found.blur_radius:.3f} m",
        "column: half path [m]   attenuated backscatter [1/(m sr)]",
    ]
    rows = zip(found.bin_edges[:-1], found.bin_edges[1:], found.column, found.column_sem)  # noqa: B905
    lines += [
        f"  {low:6.1f} - {high:4.1f}        {value:.4e} +- {sem:.1e}"
        for low, high, value, sem in rows
    ]
    return "\n".join(lines)


def draw(path: Path, found: Response, *, title: str) -> None:
    """Write a picture (PNG or SVG by the suffix) of the column, with the bottom's depth marked.

    Raises
    ------
    UserError
        When the suffix is neither.
    """
    from matplotlib.figure import Figure

    if path.suffix.lower() not in (".png", ".svg"):
        raise UserError(f"{path}: --plot writes .png or .svg. Choose one of them")
    figure = Figure(figsize=(7.0, 5.0), layout="constrained")
    axes = figure.subplots()
    middle = 0.5 * (found.bin_edges[:-1] + found.bin_edges[1:])
    axes.errorbar(
        middle, found.column, yerr=1.96 * found.column_sem, fmt=".-", color="#0072B2", lw=1.0
    )
    axes.axvline(found.bottom_depth, color="#D55E00", ls="--", lw=1.2)
    axes.set_yscale("log")
    axes.set_xlabel("half of the path length [m]")
    axes.set_ylabel("attenuated backscatter [1/(m sr)]")
    axes.set_title(title, loc="left")
    axes.text(
        0.98, 0.97,
        f"bottom at {found.bottom_depth:g} m (dashed):\n"
        f"two-way transmission {found.two_way.value:.3e}\n"
        f"within 10 ns {found.two_way_10ns.value:.3e}",
        transform=axes.transAxes, ha="right", va="top",
        bbox={"facecolor": "white", "edgecolor": "none"},
    )  # fmt: skip
    axes.grid(alpha=0.3)
    content = io.BytesIO()
    metadata = {"Software": None} if path.suffix.lower() == ".png" else {"Date": None}
    figure.savefig(content, format=path.suffix[1:].lower(), dpi=150, metadata=metadata)
    write_whole(path, content.getvalue())
