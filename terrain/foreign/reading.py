"""The parent's side: start a child for a file, wait, and take its arrays or its faults."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from terrain.foreign.child import DONE, FAULTY, OUT_OF_MEMORY
from terrain.foreign.faults import ForeignFileError, speaks_of_memory
from terrain.foreign.limits import GIB, Limits

ROOT = Path(__file__).resolve().parents[2]
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
GDAL = {"GDAL_CACHEMAX": "64", "CPL_VSIL_CURL_ALLOWED_EXTENSIONS": "{noext}"}
OUT_OF_TIME = -int(getattr(signal, "SIGXCPU", 0))  # Windows has none
LAST_WORDS = 4096  # [bytes]


def read_foreign(
    reader: str, path: Path, *, limits: Limits, **arguments: Any
) -> dict[str, NDArray[Any]]:
    """Return the arrays that a reader makes of a file, by name; read in a child process.

    The child is a fresh interpreter, not a fork, so that any thread may ask for it.

    Parameters
    ----------
    reader : str
        ``module:function``; the function takes the path as text and the arguments, returns a
        mapping of arrays, and raises `ReaderError` for what is wrong.
    path : Path
        The file.
    limits : Limits
        For the child.
    **arguments
        Anything that JSON can hold.

    Raises
    ------
    ForeignFileError
        With the reader's faults, or one that says how the child ended.
    """
    request = {
        "reader": reader,
        "memory": limits.memory,
        "processor_time": limits.processor_time,
        "arguments": {"path": str(path), **arguments},
    }
    with TemporaryDirectory(prefix="bathyflash-") as folder:
        answer, faults, words = (Path(folder) / name for name in ("a.npz", "f.json", "words"))
        command = [sys.executable, "-P", "-m", "terrain.foreign.child"]
        with words.open("wb") as sink:
            status = _status_of([*command, json.dumps(request), answer, faults], sink, limits)
        if status == DONE:
            with np.load(answer, allow_pickle=False) as arrays:
                return dict(arrays)
        if status == FAULTY:
            raise ForeignFileError(path, json.loads(faults.read_text(encoding="utf-8")))
        raise ForeignFileError(path, [_ending(status, _said(words, faults), limits)])


def _status_of(command: list[Any], sink: Any, limits: Limits) -> int | None:
    """Return the child's exit status, None when it had to be stopped."""
    known = os.environ.get("PYTHONPATH")
    places = [str(ROOT), *([known] if known else [])]
    try:
        return subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            stdout=sink,
            stderr=sink,
            env=os.environ | ONE_THREAD | GDAL | {"PYTHONPATH": os.pathsep.join(places)},
            timeout=limits.waiting_time,
            check=False,
        ).returncode
    except subprocess.TimeoutExpired:
        return None


def _said(words: Path, faults: Path) -> str:
    """Return the last words of the child."""
    if faults.exists():
        return " ".join(json.loads(faults.read_text(encoding="utf-8")))
    with words.open("rb") as source:
        source.seek(max(0, words.stat().st_size - LAST_WORDS))
        return source.read().decode(errors="replace")


def _ending(status: int | None, said: str, limits: Limits) -> str:
    """Return what a child's end says of the file."""
    if status is None:
        return f"could not be read within {limits.waiting_time} s. it may be damaged"
    if status == OUT_OF_TIME:
        return (
            f"could not be read within {limits.processor_time} s of processor time. "
            "it may be damaged; otherwise cut or coarsen it"
        )
    if status == OUT_OF_MEMORY or speaks_of_memory(said):
        return (
            f"asks for more memory than the {limits.memory / GIB:.1f} GiB allowed. "
            "it may be damaged; otherwise cut or coarsen it"
        )
    if status < 0:
        return f"the reader crashed ({signal.Signals(-status).name}). the file is damaged"
    last = said.strip().splitlines() or [f"exit status {status}"]
    return f"the reader failed. {last[-1]}"
