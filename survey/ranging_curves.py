"""How often each way of ranging finds the bottom, by depth and strength, at equal false alarms.

    python -m survey.ranging_curves -o docs

Flashes of the gallery's `too-deep` over a bed that falls through the limit, and over water without
a bottom; readings are drawn anew several times. The plain method's stated rate is raised until it
fires falsely at least as often as the matched filter, both measured over the bottomless water.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.constants import speed_of_light

from survey.cloud.bottom_search import SEARCHES
from survey.cloud.echo import Echo
from survey.cloud.georeference import pixel_rays
from survey.cloud.noise import NoiseModel, gate_sums
from survey.cloud.truth import FALSE_BOTTOM_ERROR, true_targets
from survey.flight.pose import Frame
from survey.preparation import Mission, prepare
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario
from survey.transport.random import COUNTS, chance

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

BEDS = {"coastal": (4.0, 2.3), "clear": (8.0, 4.0)}  # depth [m] and slope [deg] of the falling bed
BOTTOMLESS_DEPTH = 400.0
FALSE_ALARM_RATE = 1e-3
RAISED = (1e-3, 5e-3, 1e-2, 2e-2, 4e-2, 8e-2, 0.16, 0.3)  # stated rates tried for the plain method
DEPTH_STEP, SNR_STEP, MOST_SNR = 0.5, 0.5, 12.0
FEWEST = 100
DIGITS = 4


@dataclass(frozen=True, kw_only=True)
class Flown:
    """One flash's light, and where its bottom truly is; arrays (rows, columns[, bins])."""

    light: FloatArray
    variance: NDArray[np.float32]
    bottom: NDArray[np.float32]
    surface_time: FloatArray
    time: FloatArray
    depth: FloatArray


def scenario_of(water: str, *, day: bool, frames: int, bottomless: bool, **more: Any) -> Scenario:
    """Return the scenario of a case."""
    depth, slope = BEDS[water]
    falling = {"kind": "slope", "depth_m": depth, "slope_deg": slope, "downhill_deg": 90.0}
    level = {"kind": "plane", "depth_m": BOTTOMLESS_DEPTH}
    changes: dict[str, Any] = {
        "water": {"type": water},
        "sun.day": day,
        "seabed": level if bottomless else falling | {"reflectance": 0.1},
        "flight.heading_deg": 90.0,
        "flight.frames_per_line": frames,
        "receiver.bins": 400,
        "processing.false_alarm_rate": FALSE_ALARM_RATE,
    }
    return load_scenario("too-deep").replace(**(changes | more))


def flown(mission: Mission, frame: Frame) -> Flown:
    """Fly a flash up to the light."""
    light = mission.engine.flash(pose=frame.pose, frame=frame.index, time=frame.time)
    targets = true_targets(
        seabed=mission.seabed,
        surface=mission.sea,
        water=mission.engine.water,
        pose=frame.pose,
        rays=pixel_rays(camera=mission.camera, pose=frame.pose),
    )
    return Flown(
        light=light.total + mission.noise.steady_light,
        variance=light.variance[:2].sum(axis=0),
        bottom=light.photo_electrons[2],
        surface_time=mission.posed_noise.surface_time(frame.pose),
        time=targets.time,
        depth=targets.depth,
    )


def drawn(
    mission: Mission, flashes: Sequence[Flown], draws: int
) -> Iterator[tuple[Flown, NDArray[Any]]]:
    """Yield every flash with readings, drawn anew so many times."""
    for number, (flash, draw) in enumerate(product(flashes, range(draws))):
        dice = chance(seed=mission.engine.seed + draw, purpose=COUNTS, frame=number)
        yield flash, mission.detector.read(flash.light, dice).counts


def look(name: str, noise: NoiseModel, flash: Flown, counts: NDArray[Any]) -> Echo:
    """Return what a way of ranging finds."""
    search = SEARCHES[name].over(
        noise=noise, variance=flash.variance, surface_time=flash.surface_time
    )
    return search.echo(counts)


def false_alarms(
    name: str, noise: NoiseModel, shots: Sequence[tuple[Flown, NDArray[Any]]]
) -> tuple[int, int]:
    """Return false bottoms over bottomless water, and the pixels that were looked at."""
    false = sum(int(look(name, noise, *shot).found.sum()) for shot in shots)
    return false, sum(shot[0].time.size for shot in shots)


def by_bins(
    value: FloatArray, edges: FloatArray, marks: Mapping[str, BoolArray]
) -> list[dict[str, float]]:
    """Return shares of marked pixels in bins of a value; bins of under 100 pixels are left out."""
    rows = []
    for low, high in pairwise(edges):
        inside = (value >= low) & (value < high)
        if inside.sum() >= FEWEST:
            row = {"from": float(low), "to": float(high), "pixels": int(inside.sum())}
            shares = {name: round(float(m[inside].mean()), DIGITS) for name, m in marks.items()}
            rows.append(row | shares)
    return rows


def curves(water: str, *, day: bool, frames: int, draws: int, **more: Any) -> dict[str, Any]:
    """Return the shares found by depth and by signal to noise, and both counts of false alarms.

    ``more`` are other keys of the scenario.
    """
    deep, bed = (
        prepare(scenario_of(water, day=day, frames=frames, bottomless=b, **more))
        for b in (True, False)
    )
    empty = list(drawn(deep, [flown(deep, f) for f in deep.frames], draws))
    false, pixels = false_alarms("matched", deep.noise, empty)
    for rate in RAISED:
        plain = deep.noise.at_rate(rate)
        plain_false, _ = false_alarms("threshold", plain, empty)
        if plain_false >= false:
            break
    parts: dict[str, list[Any]] = {"depth": [], "snr": [], "threshold": [], "matched": []}
    parts |= {"threshold_false": [], "matched_false": []}
    for flash, counts in drawn(bed, [flown(bed, f) for f in bed.frames], draws):
        parts["depth"].append(flash.depth.ravel())
        parts["snr"].append(_ratio(flash, bed.noise).ravel())
        for name, noise in (("threshold", bed.noise.at_rate(rate)), ("matched", bed.noise)):
            echo = look(name, noise, flash, counts)
            off = (
                np.abs(echo.time - flash.time) * 0.5 * speed_of_light / bed.engine.water.group_index
            )
            right = off <= FALSE_BOTTOM_ERROR
            parts[name].append((echo.found & right).ravel())
            parts[f"{name}_false"].append((echo.found & ~right).ravel())
    all_ = {name: np.concatenate(values) for name, values in parts.items()}
    depth, snr = all_.pop("depth"), all_.pop("snr")
    return {
        "water": water,
        "day": day,
        "bottomless_pixels": pixels,
        "matched_stated_rate": FALSE_ALARM_RATE,
        "matched_false_alarms": false,
        "threshold_stated_rate": rate,
        "threshold_false_alarms": plain_false,
        "by_depth_m": by_bins(depth, np.arange(0.0, depth.max() + DEPTH_STEP, DEPTH_STEP), all_),
        "by_snr": by_bins(snr, np.arange(0.0, MOST_SNR, SNR_STEP), all_),
    }


def _ratio(flash: Flown, noise: NoiseModel) -> FloatArray:
    """Return signal over the root of signal and noise in the bottom's best gate, true values."""
    sums = gate_sums(noise.detector.mean(flash.bottom.astype(np.float64)), noise.gate_bins)
    best = sums.argmax(axis=-1)[..., None]
    signal = np.take_along_axis(sums, best, -1)[..., 0]
    mean = np.take_along_axis(gate_sums(noise.bottomless, noise.gate_bins), best, -1)[..., 0]
    return np.asarray(signal / np.sqrt(np.maximum(signal + mean, 1e-9)))


def draw(cases: Sequence[Mapping[str, Any]], path: Path) -> None:
    """Draw the curves of all cases."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(4.2 * len(cases), 6.6), layout="constrained")
    axes = figure.subplots(2, len(cases), sharey=True, squeeze=False)
    for column, case in enumerate(cases):
        for row, key in enumerate(("by_depth_m", "by_snr")):
            ax, rows = axes[row][column], case[key]
            middle = [0.5 * (each["from"] + each["to"]) for each in rows]
            for name, colour in (("threshold", "tab:orange"), ("matched", "tab:blue")):
                ax.plot(middle, [each[name] for each in rows], color=colour, label=name)
                wrong = [each[f"{name}_false"] for each in rows]
                ax.plot(middle, wrong, color=colour, ls=":", label=f"{name}, over 1 m off")
            ax.grid(alpha=0.3)
            ax.set_xlabel("depth [m]" if row == 0 else "bottom's signal to noise in its gate [1]")
        axes[0][column].set_title(
            f"{case['water']} water, {'day' if case['day'] else 'night'}\nfalse over deep water: "
            f"threshold {case['threshold_false_alarms']}, matched {case['matched_false_alarms']}"
            f" of {case['bottomless_pixels']}",
            fontsize=9,
        )
    for row in (0, 1):
        axes[row][0].set_ylabel("share of pixels [1]")
    axes[0][0].legend(fontsize=8)
    figure.savefig(path, dpi=100)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure the curves and write ``ranging.json`` and ``ranging.png``."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("-o", "--output", type=Path, default=Path("docs"))
    parser.add_argument("--frames", type=int, default=7)
    parser.add_argument("--draws", type=int, default=2)
    given = parser.parse_args(arguments)
    cases = [
        curves(water, day=day, frames=given.frames, draws=given.draws)
        for water, day in product(BEDS, (True, False))
    ]
    (given.output / "ranging.json").write_text(json.dumps(cases) + "\n")
    draw(cases, given.output / "ranging.png")


if __name__ == "__main__":
    main()
