"""A warm process that runs the program on one input after another, with time and memory of each.

``python -m tests.bad_input.nursery``: a job a line on standard input, JSON; an answer a line on
standard output. Readers of foreign files, for which the program starts a fresh interpreter, are
forked from the warm one, under the same limits. A job that keeps the processor for too long ends
the process.
"""

from __future__ import annotations

import gc
import importlib
import json
import os
import resource
import signal
import sys
import traceback
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

from typer.main import get_command

from survey.cli import app
from terrain.foreign import child, reading
from terrain.foreign.limits import MEGABYTE, Limits
from tests.bad_input import meaning

READERS = (
    *("laspy", "lazrs", "rasterio", "trimesh", "scipy.spatial", "survey.flight.files.foreign"),
    *("survey.optics.water.cast_file", "terrain.foreign.cloud_reader"),
    *("terrain.foreign.mesh_reader", "terrain.foreign.raster_reader"),
)
FRESH_BYTES = 300 * MEGABYTE  # that a fresh interpreter with a reader's libraries maps
LONGEST_SECONDS = 100.0


def main() -> None:
    """Answer jobs until there are no more."""
    for name in READERS:
        importlib.import_module(name)
    reading._status_of = _forked_reader
    gc.freeze()
    command = get_command(app)
    for line in sys.stdin:
        signal.setitimer(signal.ITIMER_PROF, LONGEST_SECONDS)
        print(json.dumps(_answer(command, **json.loads(line))), flush=True)


def _answer(command: Any, words: list[str], means: str, path: str) -> dict[str, Any]:
    """Run a command; ask what its input means where that was accepted."""
    begun, status, wrong = _processor_seconds(), 0, []
    with redirect_stdout(StringIO()) as out, redirect_stderr(StringIO()) as err:
        try:
            command.main(words, prog_name="bathyflash")
        except SystemExit as end:
            status = end.code if isinstance(end.code, int) else 0
    seconds = _processor_seconds() - begun
    if status == 0 and means:
        try:
            wrong = getattr(meaning, means)(Path(path))
        except Exception:
            wrong = [traceback.format_exc()]
    return {
        "status": status,
        "out": out.getvalue(),
        "err": err.getvalue(),
        "wrong": wrong,
        "processor_seconds": seconds,
        "bytes": max(_own_bytes(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024),
    }


def _own_bytes() -> int:
    """Return the most that was resident since this program began.

    `resource` would tell of the process that started it, too, if that was larger.
    """
    status = Path("/proc/self/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) * 1024


def _processor_seconds() -> float:
    both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(used.ru_utime + used.ru_stime for used in both)


def _forked_reader(command: list[Any], sink: Any, limits: Limits) -> int:
    """Read in a fork under the limits of the real child; return its exit status."""
    *_, request, answer, faults = command
    asked = json.loads(request)
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    asked["memory"] += max(0, mapped - FRESH_BYTES)
    number = os.fork()
    if number == 0:
        status = 1
        try:
            for stream in (1, 2):
                os.dup2(sink.fileno(), stream)
            status = child.main([json.dumps(asked), str(answer), str(faults)])
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(status)
    return os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])


if __name__ == "__main__":
    main()
