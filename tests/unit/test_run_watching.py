"""Who flies into a run folder, how far it is, and what it wrote down."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from survey.cli import app
from survey.exit_status import BAD_INPUT
from survey.journal import Note, write_note
from survey.mission import fly
from survey.progress import Unwatched
from survey.run_folder import JOURNAL, RunFolder
from survey.run_lock import BusyRunError, pilot_of, sole_pilot
from survey.run_log import logged
from survey.run_status import RunStatus
from survey.scenario.scenario import Scenario

HOLDER = """
import sys, time
from pathlib import Path
from survey.run_lock import sole_pilot
with sole_pilot(Path(sys.argv[1])):
    print("flying", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def scenario(tables: dict[str, Any], tmp_path: Path) -> Scenario:
    return Scenario.from_tables(tables, name="reef.toml", folder=tmp_path)


@pytest.fixture
def run(scenario: Scenario, tmp_path: Path) -> Path:
    return RunFolder.open(tmp_path / "run", scenario).path


@pytest.fixture
def other_process(run: Path) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-c", HOLDER, str(run)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "flying\n"
        yield process
        process.kill()


def test_a_second_process_is_refused_at_once(
    scenario: Scenario, run: Path, other_process: subprocess.Popen[str]
) -> None:
    start = time.monotonic()
    for refly in (False, True):
        with pytest.raises(BusyRunError, match=f"process {other_process.pid} on .* Wait for it"):
            fly(scenario, run, refly=refly)
    with pytest.raises(BusyRunError), sole_pilot(run):
        pass
    assert time.monotonic() - start < 2.0


def test_a_killed_process_leaves_the_folder_free(
    run: Path, other_process: subprocess.Popen[str]
) -> None:
    pilot = pilot_of(run)
    assert pilot is not None
    assert pilot.process == other_process.pid
    other_process.send_signal(signal.SIGKILL)
    other_process.wait()
    assert pilot_of(run) is None
    with sole_pilot(run):
        pass


def test_a_forked_worker_that_outlives_its_pilot_does_not_keep_the_folder(run: Path) -> None:
    told, tell = os.pipe()
    with sole_pilot(run):
        worker = os.fork()
        if worker == 0:
            os.write(tell, b"forked")
            time.sleep(60)
            os._exit(0)
        assert os.read(told, 6) == b"forked"
    try:
        assert pilot_of(run) is None
        with sole_pilot(run):
            pass
    finally:
        os.kill(worker, signal.SIGKILL)
        os.waitpid(worker, 0)


def test_status_tells_frames_rate_and_pilot(run: Path) -> None:
    write_note(run / JOURNAL, Note(frame=0, sha256="", done=100.0))
    stopped = RunStatus.of(run)
    assert stopped.lines == ["a test", "1/2 frames, stopped"]
    with logged(run, Unwatched()) as log:
        log.started(2)
    with sole_pilot(run):
        flying = RunStatus.of(run)
    assert f"1/2 frames, flown by process {os.getpid()} on " in flying.lines[1]
    assert flying.lines[-1].endswith("2 frames to fly")


def test_status_of_no_run_is_an_error(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["status", str(tmp_path)])
    assert result.exit_code == BAD_INPUT
    assert "no run" in result.output


def test_the_log_tells_what_ended_a_run(run: Path) -> None:
    def fail() -> None:
        with logged(run, Unwatched()) as log:
            log.noticed("frame 3 is flown again: its file is gone")
            log.frame_done(3, 1.25)
            raise ValueError("no room")

    with pytest.raises(ValueError, match="no room"):
        fail()
    lines = [line.split(" ", 1)[1] for line in (run / "log.txt").read_text().splitlines()]
    assert lines == [
        "frame 3 is flown again: its file is gone",
        "frame 3: 1.25 s",
        "ended by ValueError: no room",
    ]
