"""What a failure looks like to the user: its lines, and the exit status of the command."""

from __future__ import annotations

import errno
import os

from survey.errors import OtherRunError, UserError

OUR_PACKAGES = {"survey", "terrain", "viewer"}
DONE, BAD_INPUT, FILE_MISSING, OTHER_RUN, OUR_FAULT, INTERRUPTED = 0, 2, 3, 5, 70, 130
MEANINGS = {
    DONE: "done",
    BAD_INPUT: "bad input: what, where and what to do stand in the message",
    FILE_MISSING: "a file is missing",
    OTHER_RUN: "the run folder belongs to another scenario or code",
    OUR_FAULT: "a fault of ours: please report it with the message",
    INTERRUPTED: "interrupted; the same command goes on",
}
TRACEBACK_VARIABLE = "BATHYFLASH_TRACEBACK"
REMEDIES: dict[int | None, str] = {
    errno.ENOSPC: "Free some space; the same command goes on from here.",
    errno.EDQUOT: "Free some space; the same command goes on from here.",
    errno.EFBIG: "Raise the limit of file sizes; the same command goes on from here.",
    errno.EIO: "Check the disk; the same command goes on from here.",
    errno.EMFILE: "Raise the limit with `ulimit -n`; the same command goes on from here.",
    errno.EROFS: "Choose a place that can be written to.",
    errno.EACCES: "Choose a place that you may use.",
}


def explain(error: BaseException) -> tuple[int, str]:
    """Return the exit status and the lines for the user.

    Examples
    --------
    >>> explain(FileNotFoundError(2, "No such file or directory", "reef.toml"))
    (3, 'reef.toml: no such file or directory.')
    >>> explain(KeyboardInterrupt())[0]
    130
    """
    if isinstance(error, KeyboardInterrupt):
        return INTERRUPTED, "interrupted. The same command goes on from here."
    if isinstance(error, OtherRunError):
        return OTHER_RUN, str(error)
    if isinstance(error, FileNotFoundError):
        return FILE_MISSING, _file_lines(error)
    if isinstance(error, OSError) and error.errno != errno.EPIPE:
        return BAD_INPUT, _file_lines(error)
    if isinstance(error, UserError) or _is_our_value_error(error):
        missing = getattr(error, "only_missing_files", False)
        return FILE_MISSING if missing else BAD_INPUT, str(error)
    return OUR_FAULT, _our_fault(error)


def _is_our_value_error(error: BaseException) -> bool:
    """Tell errors such as `terrain.coverage.CoverageError`, written for users, from accidents."""
    return isinstance(error, ValueError) and type(error).__module__.split(".")[0] in OUR_PACKAGES


def _file_lines(error: OSError) -> str:
    if error.filename is None or error.strerror is None:
        return str(error)
    words = f"{error.filename}: {error.strerror.lower()}."
    return f"{words} {REMEDIES[error.errno]}" if error.errno in REMEDIES else words


def _our_fault(error: BaseException) -> str:
    if isinstance(error, MemoryError):
        return "out of memory. Fly with fewer workers, fewer bins or fewer pixels."
    text = " ".join(str(error).split())
    hint = "" if os.environ.get(TRACEBACK_VARIABLE) else f" {TRACEBACK_VARIABLE}=1 shows where."
    return f"a fault of bathyflash: {type(error).__name__}: {text}.{hint}"
