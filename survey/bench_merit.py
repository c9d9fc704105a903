"""The fast engine's figure of merit, counted in those of the textbook engine.

The figure of merit is 1 / (error^2 time). Error means the same for both engines: the standard
deviation of repeated flashes in the bottom gate, the 10 ns around the peak of each pixel's expected
bottom echo, over what is expected there. It is told in two ways:

- pooled: the gates of all pixels are summed, and the sum has an error. The verdict goes by this;
- per pixel: every pixel's gate has an error, of which the root mean square is taken.

The textbook engine's error lies in few and giant scores (`survey.transport.textbook`). Thirty
flashes meet hardly any of them and show a smaller error than there is, which is in its favour;
where they do meet one, the pooled error jumps above 10 % and there is no verdict. The error of
single pixels is above 100 % in any run that ends.

The scores are the more giant the narrower the receiver: through one of 5 mm radius, in coastal
water 10 m deep, eight million photons err by 3 % as their scatter shows and by 25 % in theory.

Both engines have a flat bottom and still water, for the textbook engine joins points through level
water alone. It does not have to search a mesh for the bottom, which is in its favour. Time is
processor time with a flash on every core: other programs on the machine do not lengthen it.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from survey.preparation import Mission, prepare
from survey.scenario.scenario import Scenario
from survey.transport.textbook import TextbookFlash, textbook_flash

FloatArray = NDArray[np.floating]
Result = TypeVar("Result")

REPLICATES, FEWEST_REPLICATES = 30, 10
TEXTBOOK_WALKS = 8_000_000
GATE_BINS = 10
WORST_TEXTBOOK_ERROR = 0.1
FARTHEST_APART = 3.0
RESAMPLINGS, LOWER_END = 2000, 0.025


class Replicates(NamedTuple):
    """Repeated flashes of an engine: the bottom gate of every pixel (flashes, pixels) in
    photo-electrons, and processor seconds a flash."""

    gates: FloatArray
    seconds: float


def figure_of_merit(
    *,
    scenario: Scenario,
    threads: int = 0,
    replicates: int = REPLICATES,
    walks: int = TEXTBOOK_WALKS,
) -> dict[str, Any]:
    """Measure both engines by repeated flashes of a scenario, its wind taken away.

    Parameters
    ----------
    scenario : Scenario
        Its bottom is level, its water level 0; the first flash is repeated.
    threads : int
        Flashes at once; 0 is one for each core.
    replicates, walks : int
        Flashes of each engine, and photons in one of the textbook engine.

    Returns
    -------
    dict
        As `compared` says, with ``largest_share`` of the textbook engine: its largest score over
        its pooled gates of all flashes [1].

    Raises
    ------
    ValueError
        When there are fewer than ten replicates.
    """
    if replicates < FEWEST_REPLICATES:
        raise ValueError(f"replicates = {replicates}: must be {FEWEST_REPLICATES} or more")
    mission = prepare(scenario.replace(**{"surface.wind_speed_m_s": 0.0}))
    workers, frames = threads or os.cpu_count() or 1, range(replicates)

    def echo(frame: int) -> FloatArray:
        flash = mission.engine.flash(pose=mission.frames[0].pose, frame=frame)
        return flash.origin("bottom").astype(np.float32)

    echo(0)
    echoes, fast_seconds = _timed(echo, frames, workers)
    expected = np.mean(echoes, axis=0)
    gate = _gate(expected)

    def traced(frame: int) -> tuple[FloatArray, float]:
        flash = _traced(mission, walks, frame)
        return _gated(flash.photo_electrons[1], gate), float(flash.largest[1])

    _traced(mission, 1, 0)
    scores, textbook_seconds = _timed(traced, frames, workers)
    textbook = Replicates(np.array([counts for counts, _ in scores]), textbook_seconds)
    fast = Replicates(np.array([_gated(echo, gate) for echo in echoes]), fast_seconds)
    found = compared(fast=fast, textbook=textbook, expected=_gated(expected, gate))
    largest = max(score for _, score in scores)
    found["figure_of_merit"]["textbook"]["largest_share"] = largest / float(textbook.gates.sum())
    return found


def compared(*, fast: Replicates, textbook: Replicates, expected: FloatArray) -> dict[str, Any]:
    """Compare two engines by their repeated flashes.

    Parameters
    ----------
    fast, textbook : Replicates
    expected : array (pixels,)
        What both engines are to find in the gate of each pixel [photo-electrons].

    Returns
    -------
    dict
        ``figure_of_merit_ratio`` and ``figure_of_merit_ratio_lower_95``, pooled: fast over
        textbook, and the lower end of its 95 % interval by the bootstrap over replicates, times
        taken as known. Both are None, no verdict, where the textbook engine's error is 10 % or
        more or the answers are more than three standard errors apart.
        ``figure_of_merit`` holds what they come from: for ``fast`` and ``textbook`` the ``seconds``
        and the pooled ``error`` of a flash, its ``error_per_pixel``, the pooled gate's mean
        ``answer`` and its standard error ``answer_error``; ``answers_apart``, the answers'
        difference in standard errors; ``pooled_ratio`` and ``per_pixel_ratio``, both with their
        ``_lower_95``, whether or not there is a verdict.

    Examples
    --------
    >>> noise = np.random.default_rng(1).normal(size=(2, 30, 1))
    >>> found = compared(fast=Replicates(100.0 + noise[0], 1.0),
    ...                  textbook=Replicates(100.0 + 5.0 * noise[1], 40.0),
    ...                  expected=np.array([100.0]))
    >>> found["figure_of_merit_ratio_lower_95"] < 1000.0 < 2.0 * found["figure_of_merit_ratio"]
    True
    """
    engines = {"fast": _figures(fast, expected), "textbook": _figures(textbook, expected)}
    quick, slow = engines["fast"], engines["textbook"]
    apart = (slow["answer"] - quick["answer"]) / np.hypot(
        slow["answer_error"], quick["answer_error"]
    )
    pooled, pooled_lower = _ratio(_pooled(fast), _pooled(textbook), expected.sum(keepdims=True))
    single, single_lower = _ratio(fast, textbook, expected)
    sound = slow["error"] < WORST_TEXTBOOK_ERROR and abs(apart) <= FARTHEST_APART
    return {
        "figure_of_merit_ratio": pooled if sound else None,
        "figure_of_merit_ratio_lower_95": pooled_lower if sound else None,
        "figure_of_merit": {
            **engines,
            "answers_apart": float(apart),
            "pooled_ratio": pooled,
            "pooled_ratio_lower_95": pooled_lower,
            "per_pixel_ratio": single,
            "per_pixel_ratio_lower_95": single_lower,
        },
    }


def _figures(engine: Replicates, expected: FloatArray) -> dict[str, float]:
    sums = engine.gates.sum(axis=1)
    once = np.ones((1, len(sums)))
    pooled = _squared_error(sums[:, None], expected.sum(keepdims=True), once)
    return {
        "seconds": engine.seconds,
        "error": float(pooled[0]) ** 0.5,
        "error_per_pixel": float(_squared_error(engine.gates, expected, once)[0]) ** 0.5,
        "answer": float(sums.mean()),
        "answer_error": float(sums.std(ddof=1)) / len(sums) ** 0.5,
    }


def _pooled(engine: Replicates) -> Replicates:
    return engine._replace(gates=engine.gates.sum(axis=1, keepdims=True))


def _ratio(fast: Replicates, textbook: Replicates, expected: FloatArray) -> tuple[float, float]:
    """Return the ratio of the figures of merit and the lower end of its 95 % interval."""
    chance = np.random.default_rng(0)

    def cost(engine: Replicates) -> FloatArray:
        """Squared error times time: as measured, then in every resampling."""
        flashes = len(engine.gates)
        drawn = chance.multinomial(flashes, np.full(flashes, 1.0 / flashes), size=RESAMPLINGS)
        counts = np.vstack([np.ones(flashes), drawn])
        return _squared_error(engine.gates, expected, counts) * engine.seconds

    ratio = cost(textbook) / cost(fast)
    return float(ratio[0]), float(np.quantile(ratio[1:], LOWER_END))


def _squared_error(gates: FloatArray, expected: FloatArray, counts: FloatArray) -> FloatArray:
    """Return the squared relative error of a flash, mean over pixels, by weighted flashes.

    ``counts`` (samples, flashes) says how often each flash counts.
    """
    flashes = len(gates)
    relative = gates / expected - 1.0
    mean, square = counts @ relative / flashes, counts @ relative**2 / flashes
    return np.asarray((square - mean**2).mean(axis=1) * flashes / (flashes - 1))


def _timed(
    work: Callable[[int], Result], frames: range, workers: int
) -> tuple[list[Result], float]:
    start = time.process_time()
    with ThreadPoolExecutor(workers) as pool:
        results = list(pool.map(work, frames))
    return results, (time.process_time() - start) / len(frames)


def _gate(echo: FloatArray) -> NDArray[np.int64]:
    """Return the bins (rows, columns, 10) around the peak of every pixel's echo."""
    bins = echo.argmax(axis=-1)[..., None] + np.arange(GATE_BINS) - GATE_BINS // 2
    return np.asarray(np.clip(bins, 0, echo.shape[-1] - 1))


def _gated(echo: FloatArray, gate: NDArray[np.int64]) -> FloatArray:
    """Return the sum of an echo over the gate of every pixel, (pixels,)."""
    in_gate = np.take_along_axis(echo, gate, axis=-1)
    return np.asarray(in_gate.sum(axis=-1, dtype=np.float64).ravel())


def _traced(mission: Mission, walks: int, frame: int) -> TextbookFlash:
    engine = mission.engine
    return textbook_flash(
        water=engine.water.surface,
        depth=-float(mission.seabed.mesh.vertices[:, 2].mean()),
        reflectance=float(mission.seabed.reflectance.mean()),
        laser=engine.laser,
        camera=engine.camera,
        receiver=engine.receiver,
        pose=mission.frames[0].pose,
        photo_electrons_per_photon=engine.photo_electrons / engine.laser.photons_per_pulse,
        walks=walks,
        seed=engine.seed,
        frame=frame,
    )
