"""Sixteen thousand frames, a dry transport in the place of photons: time, memory, resuming.

The frames are copies of one that was flown, under other numbers; all else is a run as it is flown,
up to its last frame.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from statistics import median

import psutil
import pytest

from survey import mission as flights
from survey.crew.outcome import Crew, Done
from survey.crew.processes import Processes
from survey.crew.threads import Threads
from survey.preparation import Mission, prepare
from survey.products.frame_file import frame_bytes
from survey.run_folder import RunFolder
from survey.scenario.load import load_scenario
from survey.scenario.scenario import Scenario
from tests.faults.rehearsal import TABLES

FRAMES, PART = 16_000, 1_000
GIB = 1 << 30


@dataclass
class Gauge:
    """Keeps when each frame was done, and the memory of this process then."""

    times: list[float] = field(default_factory=list)
    resident: list[int] = field(default_factory=list)

    def started(self, total: int) -> None:
        """Do nothing."""

    def noticed(self, text: str) -> None:
        """Do nothing."""

    def frame_done(self, index: int, seconds: float) -> None:
        """Read clock and memory."""
        self.times.append(time.perf_counter())
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        self.resident.append(pages * os.sysconf("SC_PAGE_SIZE"))

    def writing(self, total: int) -> None:
        """Do nothing."""

    def written(self, steps: int) -> None:
        """Do nothing."""

    def finished(self, summary: str) -> None:
        """Do nothing."""

    def median_seconds(self, part: slice) -> float:
        """Return the median time between frames of a part of them [s]."""
        times = self.times[part]
        return median(late - early for early, late in pairwise(times))


def dry(monkeypatch: pytest.MonkeyPatch, mission: Mission) -> int:
    """Let every frame be a copy of the first and the run end with the last; return its bytes."""
    first = flights.fly_frame(mission, mission.frames[0])
    monkeypatch.setattr(flights, "prepare", lambda scenario: mission)
    monkeypatch.setattr(flights, "fly_frame", lambda mission, frame: first)
    monkeypatch.setattr(flights, "_write_products", lambda *arguments: {})
    monkeypatch.setattr(flights, "summary", lambda folder, metrics: "")
    return len(frame_bytes(first))


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_time_and_memory_of_a_frame_stay_flat_and_a_resume_starts_soon(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flight = TABLES["flight"] | {"frames_per_line": 400, "lines": FRAMES // 400, "speed_m_s": 1.0}
    scenario = Scenario.from_tables(
        TABLES | {"flight": flight, "camera": {"rows": 8, "columns": 16}},
        name="large.toml",
        folder=tmp_path,
    )
    mission = prepare(scenario)
    assert len(mission.frames) == FRAMES
    size, gauge, run = dry(monkeypatch, mission), Gauge(), tmp_path / "run"
    flights.fly(scenario, run, crew=Processes(workers=2), watch=gauge)

    first, last = gauge.median_seconds(slice(PART)), gauge.median_seconds(slice(-PART, None))
    start = time.perf_counter()
    assert len(RunFolder.open(run, scenario).whole) == FRAMES
    resume = time.perf_counter() - start
    print(
        f"\n{FRAMES} frames of {size} bytes: {1e3 * first:.2f} ms a frame at first, "
        f"{1e3 * last:.2f} ms at last; {gauge.resident[PART] / 1e6:.0f} MB resident at frame "
        f"{PART}, {gauge.resident[-1] / 1e6:.0f} MB at the end; a resume starts after "
        f"{resume:.1f} s"
    )
    assert abs(last / first - 1.0) < 0.1
    assert gauge.resident[-1] - gauge.resident[PART] < 0.02 * GIB
    assert max(gauge.resident) < 2 * GIB
    assert resume < 2.0 + 0.005 * FRAMES


def seconds(act: Callable[[], object]) -> float:
    """Return how long something takes [s]."""
    start = time.perf_counter()
    act()
    return time.perf_counter() - start


@pytest.fixture(scope="module")
def _idle_cores() -> None:
    if (os.cpu_count() or 1) < 2 or psutil.cpu_percent(interval=3.0) > 10.0:
        pytest.skip("needs two idle cores")


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.usefixtures("_idle_cores")
@pytest.mark.parametrize("kind", [Threads, Processes])
def test_two_workers_fly_almost_twice_as_many_frames(kind: Callable[..., Crew]) -> None:
    """Of full size; starting the workers counts."""
    mission = prepare(load_scenario("sandbar"))
    mission.scattering()

    def work(index: int) -> bytes:
        return flights.frame_file(mission, index % len(mission.frames))

    def fly(workers: int) -> None:
        outcomes = list(kind(workers=workers).fly(work, range(24)))
        assert all(isinstance(outcome, Done) for outcome in outcomes)

    fly(1)
    one, two = seconds(lambda: fly(1)), seconds(lambda: fly(2))
    print(f"\n{kind.__name__}: {one / two:.2f} times as fast, {1e3 * one / 24:.0f} ms a frame")
    assert one / two > 1.8


@pytest.mark.slow
@pytest.mark.timeout(900)
def test_what_is_not_physics_takes_little_of_a_frame(tmp_path: Path) -> None:
    """Handing out, packing, sending, writing, flushing and noting a frame of full size."""
    mission = prepare(load_scenario("sandbar"))
    flown = seconds(lambda: [flights.fly_frame(mission, frame) for frame in mission.frames[:8]]) / 8
    first = flights.fly_frame(mission, mission.frames[0])
    run = RunFolder.open(tmp_path / "run", load_scenario("sandbar"))

    def all_but_flying() -> None:
        for outcome in Processes(workers=1).fly(lambda index: frame_bytes(first), range(64)):
            assert isinstance(outcome, Done)
            run.keep(outcome.index, outcome.result)

    rest = seconds(all_but_flying) / 64
    print(f"\n{1e3 * flown:.0f} ms of flying, {1e3 * rest:.1f} ms of the rest a frame")
    assert rest < 0.1 * flown
