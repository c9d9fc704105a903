"""The child: ``python -P -m terrain.foreign.child REQUEST ANSWER FAULTS``.

The request is JSON: the reader's name, its arguments and the limits. The answer is an .npz of the
arrays that the reader returns, the faults a JSON list of what it found instead.
"""

from __future__ import annotations

import importlib
import json
import sys
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from terrain.foreign.faults import ReaderError

DONE, FAULTY, OUT_OF_MEMORY, BROKEN = 0, 10, 11, 12


def main(arguments: list[str]) -> int:
    """Read what is asked for and return the exit status."""
    request, answer, faults = json.loads(arguments[0]), Path(arguments[1]), Path(arguments[2])
    confine(memory=request["memory"], processor_time=request["processor_time"])
    try:
        _write(answer, _reader(request["reader"])(**request["arguments"]))
    except ReaderError as fault:
        faults.write_text(json.dumps(fault.faults), encoding="utf-8")
        return FAULTY
    except MemoryError:
        return OUT_OF_MEMORY
    except Exception as error:
        faults.write_text(json.dumps([f"{type(error).__name__}: {error}"]), encoding="utf-8")
        return BROKEN
    return DONE


def confine(*, memory: int, processor_time: int) -> None:
    """Limit this process's address space [bytes] and processor time [s], where the system can."""
    try:
        import resource
    except ImportError:  # Windows: the parent's clock is all there is
        return
    for kind, most in (
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_CPU, processor_time),
        (resource.RLIMIT_AS, memory),
    ):
        _, hard = resource.getrlimit(kind)
        allowed = most if hard == resource.RLIM_INFINITY else min(most, hard)
        with suppress(ValueError, OSError):  # macOS has no limit of address space
            resource.setrlimit(kind, (allowed, hard))


def _reader(name: str) -> Any:
    module, _, function = name.partition(":")
    return getattr(importlib.import_module(module), function)


def _write(answer: Path, arrays: Mapping[str, Any]) -> None:
    import numpy as np

    with answer.open("wb") as file:
        np.savez(file, allow_pickle=False, **arrays)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
