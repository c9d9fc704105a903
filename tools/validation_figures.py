"""Draws the figures of docs/validation.md from the tests' own numbers: `make figures`.

Published values and settings are those that the tests hold the code to; what the code gives is
computed anew, with fewer light paths than in the longest of these tests.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from survey.paper.instrument import PUBLISHED as PUBLISHED_DEPTHS
from survey.transport.slab import slab
from terrain.waves.dispersion import depth_factor, wavenumber
from terrain.waves.spectrum import jonswap, pierson_moskowitz
from tests.physics import test_adding_doubling as doubling
from tests.physics import test_paper_result, test_wave_spectra
from tests.physics.test_profile import QUANTITIES, computed, published
from tests.physics.test_slab import PUBLISHED, QUANTILE

FOLDER = Path(__file__).parents[1] / "docs" / "validation"
BLUE, RED, GREY = "#0072b2", "#d55e00", "#666666"
MODELS = {"Ed": "$E_d$", "Eou": "$E_{ou}$", "Lu": "$L_u$"}
WALKS_OF_SLAB, WALKS_OF_PROFILE = 3_200_000, 960_000


def mobley() -> Figure:
    """Light at depths beside the models of Mobley et al. (1993), mean and spread."""
    figure = Figure(figsize=(8.0, 3.4), layout="constrained")
    for axes, problem in zip(figure.subplots(1, 2, sharey=True), (1, 2), strict=True):
        profile, models = computed(problem, 0.9, WALKS_OF_PROFILE), published(problem, 0.9)
        for (name, label), shift in zip(MODELS.items(), (-0.25, 0.0, 0.25), strict=True):
            value = getattr(profile, QUANTITIES[name])
            error = getattr(profile, f"{QUANTITIES[name]}_error")
            mean, spread = np.array([models[name, depth] for depth in profile.depth]).T
            place = profile.depth + shift
            axes.bar(place, 200 * spread, 0.2, -100 * spread, color="#dddddd")
            axes.errorbar(
                place, 100 * (value / mean - 1), 100 * QUANTILE * error / mean, fmt="o", ms=4,
                color={"Ed": BLUE, "Eou": RED, "Lu": GREY}[name], label=label,
            )  # fmt: skip
        axes.axhline(0.0, color="black", lw=0.6)
        axes.set(title=f"Problem {problem}, albedo 0.9", xlabel="optical depth", xticks=(1, 5, 10))
    figure.axes[0].set_ylabel("here over the models' mean, less 1 [%]")
    figure.axes[0].legend(loc="lower left", ncols=3, fontsize="small")
    return figure


def _slabs() -> Iterator[tuple[str, float, float, str]]:
    """Yield name, deviation and 99.9 % interval [%] of every slab's light, and its colour."""
    cases: list[tuple[str, dict[str, Any], tuple[float, ...]]] = [
        (name, optics, light) for name, (optics, light) in PUBLISHED.items()
    ]
    for name, (phase, albedo) in doubling.WATERS.items():
        for thickness in doubling.THICKNESSES:
            optics = {"optical_thickness": thickness, "albedo": albedo, "phase_function": phase}
            light = doubling.Slab(phase, a=albedo, b=thickness).rt()[:2]
            cases.append((f"{name}, {thickness:g} (adding-doubling)", optics, light))
    for name, optics, light in cases:
        found = slab(**optics, walks=WALKS_OF_SLAB)
        here = (
            ("R", found.reflectance, found.reflectance_error, BLUE),
            ("T", found.transmittance, found.transmittance_error, RED),
        )
        for expected, (letter, value, error, colour) in zip(light, here, strict=False):
            off, reach = value / expected - 1.0, QUANTILE * error / expected
            yield f"{name}: {letter}", 100 * off, 100 * reach, colour


def slabs() -> Figure:
    """Reflectance and transmittance of slabs beside published ones and adding-doubling."""
    figure = Figure(figsize=(8.0, 5.2), layout="constrained")
    axes = figure.subplots()
    rows = list(_slabs())
    for place, (_, off, reach, colour) in enumerate(rows):
        axes.errorbar(off, place, xerr=reach, fmt="o", ms=4, color=colour)
    axes.axvline(0.0, color="black", lw=0.6)
    axes.set(xlabel="here over the expected value, less 1 [%]; bars: 99.9 % of the Monte Carlo")
    axes.set_yticks(range(len(rows)), [name for name, *_ in rows])
    axes.invert_yaxis()
    return figure


def spectra() -> Figure:
    """Spectra of waves beside the digits of another library."""
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    axes = figure.subplots()
    points = test_wave_spectra.FREQUENCIES
    frequency = np.geomspace(0.07, 0.6, 400)
    grown = jonswap(frequency, peak_frequency=0.13, alpha=0.012)
    shallow = depth_factor(np.array([wavenumber(1.0 / f, depth=8.0) for f in frequency]), depth=8.0)
    curves = (
        ("JONSWAP", grown, test_wave_spectra.THEIR_JONSWAP, RED),
        ("the same in 8 m of water, TMA", grown * shallow, test_wave_spectra.THEIR_TMA, GREY),
        (
            "Pierson-Moskowitz", pierson_moskowitz(frequency, peak_frequency=0.13),
            test_wave_spectra.THEIR_PIERSON_MOSKOWITZ, BLUE,
        ),
    )  # fmt: skip
    for label, density, theirs, colour in curves:
        axes.loglog(frequency, density, color=colour, label=label)
        axes.loglog(points, theirs, "o", mfc="none", color=colour)
    axes.set(xlabel="frequency [Hz]", ylabel="density [m²/Hz]", ylim=(3e-3, 40.0))
    axes.legend(title="lines: here, rings: wavespectra 4.9", fontsize="small")
    return figure


def paper_depths() -> Figure:
    """The six depths of the paper beside those that the tests keep."""
    figure = Figure(figsize=(8.0, 2.6), layout="constrained")
    axes: Axes = figure.subplots()
    names = []
    for sun, waters in PUBLISHED_DEPTHS.items():
        for name, depth in waters.items():
            here = test_paper_result.STORED[sun][name]
            axes.plot([depth, here], [len(names)] * 2, color=GREY, lw=1)
            axes.plot(depth, len(names), "v", mfc="white", color=BLUE, ms=8)
            axes.plot(here, len(names), "o", color=RED, ms=5)
            names.append(f"{name}, {sun}")
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set(xlabel="depth where the column's ratio of powers is 10 [m]; ▽ published, ● here")
    return figure


FIGURES: dict[str, Callable[[], Figure]] = {
    "mobley": mobley,
    "slabs": slabs,
    "spectra": spectra,
    "paper-depths": paper_depths,
}


def main(names: list[str]) -> None:
    """Draw the named figures, or all."""
    FOLDER.mkdir(exist_ok=True)
    style = {"svg.hashsalt": "bathyflash", "font.size": 9, "axes.spines.top": False}
    with mpl.rc_context(style | {"axes.spines.right": False}):
        for name in names or FIGURES:
            FIGURES[name]().savefig(FOLDER / f"{name}.svg", metadata={"Date": None})
            print(f"drawn: {FOLDER / name}.svg")


if __name__ == "__main__":
    main(sys.argv[1:])
