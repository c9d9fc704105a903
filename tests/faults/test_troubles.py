"""Whatever the machine does: a run finishes alike, or says clearly what is wrong and goes on."""

from __future__ import annotations

import errno
import json
import os
import resource
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from survey import mission as flights
from survey.crew.outcome import Crew
from survey.crew.processes import Processes
from survey.exit_status import BAD_INPUT, INTERRUPTED, OUR_FAULT
from survey.interrupt import stoppable
from survey.preparation import Mission
from tests.faults.rehearsal import DISK_BROKEN, DISK_FULL, ONE, Rehearsal, Seam

TWO = Processes(workers=2)
HELD = ExitStack()
Trouble = Callable[[], None]


def limited(limit: int, amount: int) -> Trouble:
    """Return what takes something away from this process."""

    def take() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(limit, (amount, resource.getrlimit(limit)[1]))

    return take


def no_more_files() -> None:
    """Leave this process two files more, at most."""
    limited(resource.RLIMIT_NOFILE, 128)()
    taken = []
    with suppress(OSError):
        while True:
            taken.append(os.open("/dev/null", os.O_RDONLY))
    for descriptor in taken[-2:]:
        os.close(descriptor)


def words(folder: Path) -> str:
    """Return what a run in a child said last."""
    return folder.with_name("words").read_text()


def is_clear(text: str, folder: Path) -> bool:
    """Tell whether an error is one line with a place and something to do."""
    return "\n" not in text and str(folder) in text and "." in text.split(": ")[-1]


@pytest.mark.parametrize(
    ("trouble", "reason"),
    [
        (limited(resource.RLIMIT_FSIZE, 1500), "file too large. Raise the limit"),
        (no_more_files, "too many open files. Raise the limit with `ulimit -n`"),
    ],
    ids=["file size", "too many files"],
)
def test_a_starved_run_says_so_and_goes_on(
    rehearsal: Rehearsal, tmp_path: Path, trouble: Trouble, reason: str
) -> None:
    run = tmp_path / "run"
    assert rehearsal.ended(run, trouble=trouble) == BAD_INPUT
    assert reason in words(run)
    assert is_clear(words(run), tmp_path)
    rehearsal.must_finish_alike(run)


def fails_at(rehearsal: Rehearsal, folder: Path, moment: int, fault: Trouble, again: bool) -> None:
    """Let the disk fail at a moment, once or for good, and then go on."""
    status = rehearsal.ended(folder, trouble=Seam(moment, fault, again=again).install)
    assert status == BAD_INPUT
    assert is_clear(words(folder), folder), words(folder)
    rehearsal.must_finish_alike(folder)


@pytest.mark.parametrize(
    ("fault", "moment"), [(DISK_FULL, 30), (DISK_BROKEN, 53)], ids=["full", "broken"]
)
def test_a_disk_that_fails_at_a_write(
    rehearsal: Rehearsal, tmp_path: Path, fault: Trouble, moment: int
) -> None:
    fails_at(rehearsal, tmp_path / "run", moment, fault, again=moment % 2 == 0)


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.parametrize("fault", [DISK_FULL, DISK_BROKEN], ids=["full", "broken"])
def test_a_disk_that_fails_at_any_write(
    rehearsal: Rehearsal, tmp_path: Path, fault: Trouble
) -> None:
    for moment in range(90):
        fails_at(rehearsal, tmp_path / f"at{moment}", moment, fault, again=moment % 2 == 0)


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A real disk of 64 kB, where we may mount one."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(place)]
    if subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("only root may mount a small disk")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def remount(place: Path, options: str) -> None:
    """Change a mounted disk."""
    subprocess.run(["mount", "-o", f"remount,{options}", str(place)], check=True)


def test_a_disk_that_is_truly_full(rehearsal: Rehearsal, small_disk: Path) -> None:
    run = small_disk / "run"
    status = rehearsal.ended(run, trouble=lambda: None)
    assert status == BAD_INPUT
    remount(small_disk, "size=64m")
    rehearsal.must_finish_alike(run)


def test_a_folder_that_is_truly_read_only(rehearsal: Rehearsal, small_disk: Path) -> None:
    """Root may write into any folder, but not on a disk that is mounted so."""
    remount(small_disk, "size=64m,ro")
    run = small_disk / "run"
    with pytest.raises(OSError, match="Read-only file system") as caught:
        rehearsal.fly(run)
    assert caught.value.errno == errno.EROFS
    remount(small_disk, "rw")
    rehearsal.must_finish_alike(run)


@pytest.mark.parametrize(
    ("number", "crew"), [(signal.SIGTERM, TWO), (signal.SIGINT, ONE)], ids=["SIGTERM", "Ctrl-C"]
)
def test_a_run_that_is_asked_to_stop_says_how_to_go_on(
    rehearsal: Rehearsal, tmp_path: Path, number: int, crew: Crew
) -> None:
    def when_one_frame_is_there() -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        HELD.enter_context(stoppable())
        slow_down(0.2)

    run = tmp_path / "run"
    child = rehearsal.start(run, crew, trouble=when_one_frame_is_there)
    while not list((run / "frames").glob("[0-9]*.npz")):
        time.sleep(0.01)
    os.kill(child, number)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == INTERRUPTED
    assert words(run) == "interrupted. The same command goes on from here."
    assert "ended by KeyboardInterrupt" in (run / "log.txt").read_text()
    rehearsal.must_finish_alike(run)


def slow_down(seconds: float) -> None:
    """Let every frame in this process take longer."""
    before = flights.fly_frame

    def slowly(mission: Mission, frame: Any) -> Any:
        time.sleep(seconds)
        return before(mission, frame)

    flights.fly_frame = slowly


def spoil(monkeypatch: pytest.MonkeyPatch, spoilt: int, act: Callable[[Any], Any]) -> None:
    """Let something happen to what is observed in one frame."""
    before = flights.observe

    def observed(mission: Mission, frame: Any) -> Any:
        seen = before(mission, frame)
        return act(seen) if frame.index == spoilt else seen

    monkeypatch.setattr(flights, "observe", observed)


def with_nan_light(seen: Any) -> Any:
    """Spoil one number of the light, as a kernel with a fault would."""
    seen.waveforms.photo_electrons[2, 3, 4, 100] = np.nan
    return seen


def out_of_memory(seen: Any) -> Any:
    """Ask for more than there is."""
    limited(resource.RLIMIT_AS, 1 << 20)()
    return np.ones(1 << 30)


def crash(seen: Any) -> Any:
    """End this process as a fault in compiled code does."""
    signal.signal(signal.SIGSEGV, signal.SIG_DFL)
    os.kill(os.getpid(), signal.SIGSEGV)


@pytest.mark.parametrize(
    ("act", "reason"),
    [
        (with_nan_light, "UnsoundFrameError: frame 2: not finite: expected light"),
        (out_of_memory, "MemoryError"),
        (crash, "its worker was ended by SIGSEGV"),
    ],
    ids=["NaN", "memory", "segfault"],
)
def test_a_frame_that_always_fails_is_set_aside_and_later_flown(
    rehearsal: Rehearsal,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    act: Callable[[Any], Any],
    reason: str,
) -> None:
    run = tmp_path / "run"
    with monkeypatch.context() as patch:
        spoil(patch, 2, act)
        rehearsal.fly(run, TWO)
    (missing,) = _metrics(run)["frames_set_aside"]
    assert missing["frame"] == 2
    assert reason in missing["reason"]
    assert _metrics(run)["frames"] == 3
    assert reason in (run / "report.html").read_text()
    log = (run / "log.txt").read_text()
    assert f"frame 2 is set aside, it failed three times: {missing['reason']}" in log
    assert "missing from all products: frames 2\n" in log
    assert not (run / "frames/000002.npz").exists()
    rehearsal.must_finish_alike(run)


def test_where_all_frames_fail_the_first_is_named(
    rehearsal: Rehearsal, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(mission: Mission, frame: Any) -> Any:
        raise ArithmeticError("no light")

    with monkeypatch.context() as patch:
        patch.setattr(flights, "observe", broken)
        assert rehearsal.ended(tmp_path / "run", TWO, trouble=lambda: None) == OUR_FAULT
    assert "no frame could be flown; frame 0: ArithmeticError: no light" in words(tmp_path / "run")
    rehearsal.must_finish_alike(tmp_path / "run")


def _metrics(run: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((run / "metrics.json").read_text())
    return found
