"""What `bathyflash response` says: as JSON, as a table, as a picture."""

from __future__ import annotations

import io
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from survey.products.writing import write_whole
from survey.scenario.faults import Fault, ScenarioError, did_you_mean

if TYPE_CHECKING:
    from survey.optics.phase import PhaseFunction
    from survey.optics.water import Water
    from survey.transport.response import Response

INDEX = 1.33  # phase and group index, as in [Lisenko2017]; only two_way_10ns depends on it
LARGEST_ATTENUATION = 25.0  # 2 K_d z: exp(-25) is 1.4e-11
LARGEST_COEFFICIENT = 1000.0  # [1/m], as in a scenario's water
LEAST_ATTENUATION = 0.04  # [1/m]: purest water absorbs 0.0442, and the column is 8 / c long
OPTION = "--phase-function"
PICTURES = (".png", ".svg")


def water_of(
    *,
    name: str | None,
    absorption: float | None,
    scattering: float | None,
    phase_function: str | None,
    bottom_depth: float,
    plot: Path | None = None,
) -> Water:
    """Return the water that the options ask for, once all of them are sound.

    Parameters
    ----------
    name : str, optional
        A named water.
    absorption, scattering : float, optional
        Coefficients instead [1/m].
    phase_function : str, optional
        With them: a CSV table, a named water's, a kind of the scenario's `water.phase_function`, or
        all of that key as TOML.
    bottom_depth : float
        So deep that some light comes back [m].
    plot : Path, optional
        A picture to be written.

    Raises
    ------
    ScenarioError
        With every fault of the options.
    """
    from survey.optics.water import PAPER_COEFFICIENTS, Water, petzold_water

    faults = _fitting_faults(name, (absorption, scattering, phase_function))
    if name is not None and name not in PAPER_COEFFICIENTS:
        names = ", ".join(PAPER_COEFFICIENTS)
        text = f"is none of {names}.{did_you_mean(name, PAPER_COEFFICIENTS)}"
        faults.append(Fault(f"--water {name}", text))
    faults += _number_faults(absorption, scattering, bottom_depth) + _plot_faults(plot)
    phase, phase_faults = _phase_function(phase_function)
    _require(faults + phase_faults)
    if name is not None:
        water = petzold_water(name, refractive_index=INDEX, group_index=INDEX)
    else:
        assert absorption is not None
        assert scattering is not None
        assert phase is not None
        water = Water(
            absorption=absorption,
            scattering=scattering,
            phase_function=phase,
            refractive_index=INDEX,
            group_index=INDEX,
        )
    _require(_beyond_the_light(water, bottom_depth))
    return water


def _fitting_faults(name: str | None, own: tuple[object, ...]) -> list[Fault]:
    """Return whether either a name or all of a water's own properties are given."""
    if (name is None) == all(value is None for value in own):
        return [Fault("water", "give either --water or --a, --b and --phase-function.")]
    if name is None and any(value is None for value in own):
        return [Fault("water", "--a, --b and --phase-function go together.")]
    return []


def _number_faults(
    absorption: float | None, scattering: float | None, bottom_depth: float
) -> list[Fault]:
    options = (("--a", absorption), ("--b", scattering), ("--bottom-depth", bottom_depth))
    faults = []
    for option, value in options:
        if value is not None and not (np.isfinite(value) and value > 0.0):
            faults.append(Fault(f"{option} {value:g}", "must be above 0 and finite."))
        elif value is not None and option != "--bottom-depth" and value > LARGEST_COEFFICIENT:
            faults.append(Fault(f"{option} {value:g}", f"must be {LARGEST_COEFFICIENT:g} or less."))
    if faults or absorption is None or scattering is None:
        return faults
    attenuation = absorption + scattering
    if attenuation >= LEAST_ATTENUATION:
        return []
    text = f"together {attenuation:g} 1/m, must be {LEAST_ATTENUATION:g} or more."
    return [Fault("--a and --b", text)]


def _plot_faults(plot: Path | None) -> list[Fault]:
    if plot is None:
        return []
    faults = []
    if plot.suffix.lower() not in PICTURES:
        faults.append(Fault(f"--plot {plot}", f"writes {' or '.join(PICTURES)}. Choose one."))
    if not plot.parent.is_dir():
        faults.append(Fault(f"--plot {plot}", f"no folder {str(plot.parent)!r}.", True))
    return faults


def _require(faults: list[Fault]) -> None:
    if faults:
        raise ScenarioError("response", faults)


def _phase_function(text: str | None) -> tuple[PhaseFunction | None, list[Fault]]:
    """Return the phase function that an option's text means, or its faults."""
    from survey.scenario.phase_parts import build_phase_function
    from survey.scenario.phase_rules import phase_faults
    from survey.scenario.phase_sections import AnyPhase
    from survey.scenario.validate import validated

    if text is None:
        return None, []
    try:
        section = validated(_as_table(text), AnyPhase, place=OPTION)
    except ScenarioError as error:
        return None, list(error.faults)
    except tomllib.TOMLDecodeError as error:
        return None, [Fault(OPTION, f"not valid TOML: {error}.")]
    faults = list(phase_faults(section, OPTION, Path.cwd()))
    return None if faults else build_phase_function(section, folder=Path.cwd()), faults


def _as_table(text: str) -> Any:
    """Return the plain table that stands for a file, a measured water, a kind, or TOML."""
    from survey.optics.water import PAPER_COEFFICIENTS

    if "{" in text:
        return tomllib.loads(f"value = {text}")["value"]
    if text in PAPER_COEFFICIENTS:
        return {"kind": "petzold", "type": text}
    is_file = Path(text).suffix or Path(text).is_file()
    return {"kind": "table", "file": text} if is_file else text


def _beyond_the_light(water: Water, bottom_depth: float) -> list[Fault]:
    """Return the fault of a bottom from which too little comes back to be computed."""
    from survey.optics.water.apparent import diffuse_attenuation

    deepest = 0.5 * LARGEST_ATTENUATION / min(diffuse_attenuation(water), water.attenuation)
    if bottom_depth <= deepest:
        return []
    return [
        Fault(
            f"--bottom-depth {bottom_depth:g}",
            f"beyond the light: from below {deepest:.3g} m less than 1e-11 of it comes back.",
        )
    ]


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
    """Write a picture (PNG or SVG by the suffix) of the column, with the bottom's depth marked."""
    from matplotlib.figure import Figure

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
