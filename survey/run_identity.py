"""Whose a run folder is: the scenario, the files, the libraries and the code behind it."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from typing import Any

from survey.errors import OtherRunError
from survey.scenario.scenario import Scenario

ROOT = Path(__file__).resolve().parent.parent
MANIFEST, SCENARIO = "manifest.json", "scenario.toml"
LIBRARIES = ("numpy", "scipy", "numba", "trimesh", "laspy", "rasterio", "pyproj")
PARTS = {
    "scenario_sha256": "scenario",
    "files_sha256": "files that the scenario names",
    "versions": "library versions",
    "lock_sha256": "lock of the libraries",
    "code_sha256": "code",
    "format": "format",
}
MOST_KEYS = 4
PROSE = {"title", "description", "expect", "source"}


def manifest_of(scenario: Scenario) -> dict[str, Any]:
    """Return what makes a run this run."""
    resolved = scenario.to_toml()
    files = {name: digest(scenario.folder / name) for name in scenario.files}
    return {
        "format": 1,
        "scenario_sha256": hashlib.sha256(resolved.encode()).hexdigest(),
        "files_sha256": files,
        "versions": {name: metadata.version(name) for name in ("bathyflash", *LIBRARIES)},
        "lock_sha256": _lock_digest(),
        "code_sha256": _code_digest(),
    }


def found_manifest(path: Path) -> dict[str, Any] | None:
    """Return the manifest in a folder; None where there is none of ours."""
    file = path / MANIFEST
    if not file.exists():
        return None
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except ValueError:
        return None
    return found if isinstance(found, dict) and "scenario_sha256" in found else None


def digest(path: Path) -> str:
    """Return the SHA-256 of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _lock_digest() -> str | None:
    """Return the hash of the lock file beside the packages; None where they came without it."""
    lock = ROOT / "requirements.lock"
    return digest(lock) if lock.exists() else None


def _code_digest() -> str:
    digest = hashlib.sha256()
    for package in ("survey", "terrain"):
        for path in sorted((ROOT / package).rglob("*.py")):
            digest.update(path.relative_to(ROOT).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()


def require_same(path: Path, found: dict[str, Any], wanted: dict[str, Any], resolved: str) -> None:
    """Raise `OtherRunError` unless a folder's manifest is the one wanted; say what differs.

    ``resolved`` is the scenario's text as it would lie in the folder.
    """
    other = differences(found, wanted)
    if "scenario" in other:
        other[other.index("scenario")] += _changed_keys(path / SCENARIO, resolved)
    if other:
        raise OtherRunError(
            f"{path}: belongs to another run: other {', other '.join(other)}. "
            "Choose another folder with -o, or fly it anew with --refly"
        )


def differences(found: Mapping[str, Any], wanted: Mapping[str, Any]) -> list[str]:
    """Return in words in what two manifests differ.

    Examples
    --------
    >>> differences({"code_sha256": "ab"}, {"code_sha256": "cd"})
    ['code']
    """
    return [words for key, words in PARTS.items() if found.get(key) != wanted.get(key)]


def _changed_keys(flown: Path, resolved: str) -> str:
    """Return in brackets which keys differ from the scenario that a folder holds."""
    try:
        before = flat_keys(tomllib.loads(flown.read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return ""
    now = flat_keys(tomllib.loads(resolved))
    changed = [key for key in now | before if before.get(key) != now.get(key)]
    changed.sort(key=lambda key: key.rsplit(".", 1)[-1] in PROSE)
    words = [
        f"{key} was {before.get(key, 'absent')}, now {now.get(key, 'absent')}"
        for key in changed[:MOST_KEYS]
    ]
    if len(changed) > MOST_KEYS:
        words.append(f"and {len(changed) - MOST_KEYS} more keys")
    return f" ({'; '.join(words)})" if words else ""


def flat_keys(tables: Mapping[str, Any], prefix: str = "") -> dict[str, str]:
    """Return the values of nested tables by dotted key, as text.

    Examples
    --------
    >>> flat_keys({"water": {"type": "clear"}, "run": {"workers": 2}})
    {'water.type': 'clear', 'run.workers': '2'}
    """
    flat: dict[str, str] = {}
    for name, value in tables.items():
        if isinstance(value, Mapping):
            flat |= flat_keys(value, f"{prefix}{name}.")
        else:
            flat[f"{prefix}{name}"] = str(value)
    return flat
