"""Figure of the matrix against a lidar of one pixel."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from survey.paper import instrument
from survey.paper.single_element import (
    EQUAL_AREA,
    EQUAL_PULSE,
    MATRIX,
    MATRIX_BUILDABLE,
    Sight,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LOOKS = {
    EQUAL_PULSE: ("single element, equal pulse energy", "#d55e00"),
    MATRIX: ("matrix, flood", "#0072b2"),
    EQUAL_AREA: ("single element, equal energy per lit area", "#cc79a7"),
    MATRIX_BUILDABLE: ("matrix of pixels that can be built", "#009e73"),
}
SNR_RANGE = (1e-1, 1e12)
PAPER_LIMIT = (3.5, 4.0)  # where [Lisenko2017] says that single-element lidars stop [1]
DEEPEST = {"P02": 13.5, "P05": 21.0, "P07": 40.0}


def draw_single_element(sights: Mapping[str, Mapping[str, Sight]]) -> Figure:
    """Draw the signal-to-noise ratio of the bottom's echo against its optical depth.

    Parameters
    ----------
    sights : mapping
        By contender and water; a line is thin and dotted where the column outshines the bottom.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12.0, 7.6), layout="constrained")
    panels = figure.subplots(2, 3, sharey=True)
    for row, sun in zip(panels, ("day", "night"), strict=True):
        for axes, water in zip(row, instrument.WATERS, strict=True):
            _panel(axes, {name: sights[name][water] for name in LOOKS}, sun)
            axes.set_xlim(0.0, DEEPEST[water])
            axes.set_title(f"{water}, {sun}", loc="left", fontsize=10)
        row[0].set_ylabel("SNR of the bottom, eq. (10), of powers [1]")
    for axes in panels[1]:
        axes.set_xlabel("optical depth of the bottom, c z [1]")
    handles = panels[0, 0].get_legend_handles_labels()
    figure.legend(*handles, loc="outside upper center", ncols=4, frameon=False, fontsize=9)
    figure.supxlabel(
        "grey: where the paper says single-element lidars stop; dashed: the required 10; "
        "dotted curves: the water column outshines the bottom",
        fontsize=9,
    )
    return figure


def _panel(axes: Axes, sights: Mapping[str, Sight], sun: str) -> None:
    axes.axvspan(*PAPER_LIMIT, color="#dddddd", lw=0)
    axes.axhline(instrument.REQUIRED_SNR, color="#555555", ls="--", lw=1.0)
    for name, found in sights.items():
        words, colour = LOOKS[name]
        x = np.linspace(found.optical_depth[0], found.optical_depth[-1], 400)
        snr = np.exp(np.interp(x, found.optical_depth, np.log(found.snr[sun] + 1e-300)))
        brighter = x <= (x[-1] if found.even is None else found.even)
        axes.plot(x, np.where(brighter, snr, np.nan), color=colour, lw=1.8, label=words)
        axes.plot(x, np.where(brighter, np.nan, snr), color=colour, lw=1.2, ls=":")
        axes.plot(found.limit[sun], instrument.REQUIRED_SNR, "o", color=colour, ms=5)
    axes.set_yscale("log")
    axes.set_ylim(*SNR_RANGE)
    axes.grid(alpha=0.25)
    axes.spines[["top", "right"]].set_visible(False)
