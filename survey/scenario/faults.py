"""What is wrong with a scenario, one line a fault."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from survey.errors import UserError

LONGEST_NAME = 100


@dataclass(frozen=True)
class Fault:
    """One fault: where in the file, and what to do about it.

    Parameters
    ----------
    place : str
        Dotted key, such as ``water.depth_m``, or a line of the file.
    text : str
        What is wrong and what to do.
    missing_file : bool
        True when the fault is a file that is not there.
    """

    place: str
    text: str
    missing_file: bool = False


class ScenarioError(UserError):
    """A scenario that cannot be flown; its text is one line a fault.

    Examples
    --------
    >>> print(ScenarioError("reef.toml", [Fault("water.depht_m", "unknown key.")]))
    reef.toml: water.depht_m: unknown key.
    """

    def __init__(self, name: str, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        self.lines = tuple(f"{name}: {fault.place}: {fault.text}" for fault in self.faults)
        super().__init__("\n".join(self.lines))

    @property
    def only_missing_files(self) -> bool:
        """True when all that is wrong are files that are not there."""
        return all(fault.missing_file for fault in self.faults)


def missing_file(place: str, file: str, folder: Path) -> Iterator[Fault]:
    """Yield the fault of a file that is not there."""
    try:
        is_there = (folder / file).is_file()
    except OSError:  # a name that is too long
        is_there = False
    if not is_there:
        name = file if len(file) <= LONGEST_NAME else f"{file[:LONGEST_NAME]}..."
        yield Fault(place, f"no file {name!r} in {folder}.", missing_file=True)


def nearest(word: str, known: Iterable[str], *, likeness: float = 0.6) -> str | None:
    """Return the known word nearest to a word, if any is at least so like it (1: the same)."""
    near = get_close_matches(word, sorted(known), n=1, cutoff=likeness)
    return near[0] if near else None


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """Return " Did you mean ...?" with the nearest known word, or nothing.

    Examples
    --------
    >>> did_you_mean("depht_m", ["depth_m", "reflectance"])
    " Did you mean 'depth_m'?"
    >>> did_you_mean("colour", ["depth_m"])
    ''
    """
    near = nearest(word, known)
    return f" Did you mean '{near}'?" if near else ""


def shown(value: object) -> str:
    """Return a value as it may stand in one line, cut short when long.

    Examples
    --------
    >>> shown("two\\nlines"), shown(True), shown(2.5)
    ("'two\\\\nlines'", 'true', '2.5')
    """
    if isinstance(value, bool):
        return str(value).lower()
    return reprlib.repr(value)


def shown_key(key: object) -> str:
    """Return one step of a dotted key, in quotes when it is not a plain word."""
    text = str(key)
    return text if text and text.replace("_", "").replace("-", "").isalnum() else shown(text)
