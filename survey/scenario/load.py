"""Scenario files read from disk."""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from survey.scenario.faults import Fault, ScenarioError, did_you_mean
from survey.scenario.gallery import gallery
from survey.scenario.scenario import Scenario, with_changes

LARGEST_FILE_BYTES = 1_000_000


def load_scenario(
    path: str | os.PathLike[str], overrides: Mapping[str, Any] | None = None
) -> Scenario:
    """Read a scenario file, or one of the gallery by its name, and check all of it.

    Parameters
    ----------
    path : path
        The file, or a name that `survey.scenario.gallery.gallery` knows.
    overrides : mapping, optional
        Values by dotted key that replace the file's, such as ``{"water.type": "harbor"}``.

    Raises
    ------
    FileNotFoundError
        When there is neither such a file nor such a name.
    ScenarioError
        With every fault of the file.

    Examples
    --------
    >>> scenario = load_scenario("sandbar", {"water.type": "harbor"})
    >>> scenario.mission.title, scenario.water.type, scenario.laser.pulse_width_ns
    ('Sandbar', 'harbor', 10.0)
    """
    file = find_scenario(path)
    tables = with_changes(_read(file), overrides or {}, name=str(file))
    return Scenario.from_tables(tables, name=str(file), folder=file.parent.absolute())


def find_scenario(path: str | os.PathLike[str]) -> Path:
    """Return the file that a path or a name of the gallery stands for.

    Raises
    ------
    FileNotFoundError
        When there is neither such a file nor such a name.
    """
    file = Path(path)
    if file.exists():
        return file
    known = gallery()
    if str(path) in known:
        return _from_here(known[str(path)])
    raise FileNotFoundError(
        f"{path}: no such file, and no scenario of that name.{did_you_mean(str(path), known)} "
        "'bathyflash scenarios' lists the names."
    )


def _from_here(file: Path) -> Path:
    """Return a path below the working folder in its short form."""
    here = Path.cwd()
    return file.relative_to(here) if file.is_relative_to(here) else file


def parse_overrides(settings: Sequence[str]) -> dict[str, Any]:
    """Return values by dotted key from ``section.key=value``; a bare word is text.

    ``section={key=value, ...}`` stands for a whole section, in TOML.

    Examples
    --------
    >>> parse_overrides(["water.type=harbor", "flight.lines=2", "sun.day=false"])
    {'water.type': 'harbor', 'flight.lines': 2, 'sun.day': False}
    >>> parse_overrides(['seabed={kind="plane", depth_m=50}'])
    {'seabed': {'kind': 'plane', 'depth_m': 50}}

    Raises
    ------
    ScenarioError
        When a setting has no equals sign, or neither a key nor a table for its section.
    """
    pairs = [setting.partition("=") for setting in settings]
    changes = [(key.strip(), _value(text.strip())) for key, _, text in pairs]
    faults = [
        Fault(setting, "not a setting. Write section.key=value or section={key=value, ...}.")
        for setting, (key, value) in zip(settings, changes, strict=True)
        if "=" not in setting or not key or ("." not in key and not isinstance(value, dict))
    ]
    if faults:
        raise ScenarioError("--set", faults)
    return dict(changes)


def parse_frames(text: str | None, count: int) -> range | None:
    """Return the frames that ``A:B`` names, from 0 and without B; None stands for all.

    Examples
    --------
    >>> parse_frames("2:5", 33), parse_frames(":4", 33), parse_frames(None, 33)
    (range(2, 5), range(0, 4), None)

    Raises
    ------
    ScenarioError
        When the text is not such a range or leaves the mission.
    """
    if text is None:
        return None
    match = re.fullmatch(r"(\d*):(\d*)", text)
    if match is None:
        raise ScenarioError("--frames", [Fault(text, "not a range. Write A:B, such as 0:8.")])
    chosen = range(int(match[1] or 0), int(match[2] or count))
    if not chosen or chosen.stop > count:
        raise ScenarioError(
            "--frames", [Fault(text, f"no such frames. The mission has 0:{count}.")]
        )
    return chosen


def _value(text: str) -> Any:
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except ValueError:
        return text


def _read(file: Path) -> dict[str, Any]:
    try:
        return tomllib.loads(_text(file))
    except RecursionError:
        fault = Fault("file", "nested too deeply.")
    except tomllib.TOMLDecodeError as error:
        fault = _syntax_fault(str(error))
    except ScenarioError:
        raise
    except ValueError as error:
        fault = Fault("file", f"not valid TOML: {error}.")
    raise ScenarioError(str(file), [fault])


def _text(file: Path) -> str:
    content, fault = b"", None
    try:
        with file.open("rb") as stream:
            content = stream.read(LARGEST_FILE_BYTES + 1)
        if len(content) <= LARGEST_FILE_BYTES:
            return content.decode("utf-8-sig")
        fault = Fault("file", "larger than 1 MB. Is it a scenario?")
    except OSError as error:
        fault = Fault("file", f"cannot be read: {error.strerror}.")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        fault = Fault(f"line {line}", "not UTF-8 text. Save the file as UTF-8.")
    raise ScenarioError(str(file), [fault])


def _syntax_fault(message: str) -> Fault:
    place = re.search(r" \(at (line \d+), column \d+\)$", message)
    if place is None:
        return Fault("file", f"not valid TOML: {message}.")
    return Fault(place[1], f"not valid TOML: {message[: place.start()]}.")
