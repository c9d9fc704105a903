"""How far a run is, seen from elsewhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from survey.errors import UserError
from survey.journal import Note, read_notes
from survey.run_folder import JOURNAL
from survey.run_identity import SCENARIO, found_manifest
from survey.run_lock import Pilot, pilot_of
from survey.run_log import LOG
from survey.scenario.components import flight_plan
from survey.scenario.load import load_scenario

RECENT = 20


@dataclass(frozen=True, kw_only=True)
class RunStatus:
    """How far a run is.

    Parameters
    ----------
    title : str
        Of the mission.
    frames : int
        Of the whole mission.
    done : int
        Frames that the journal has; `run` verifies them when it goes on.
    pilot : Pilot or None
        Who flies now.
    rate : float or None
        Frames a second over the last 20 [1/s]; None where nobody flies or too few are done.
    has_products : bool
        Whether metrics.json stands there.
    last_words : str
        The last line of the log.
    """

    title: str
    frames: int
    done: int
    pilot: Pilot | None
    rate: float | None
    has_products: bool
    last_words: str

    @classmethod
    def of(cls, folder: Path) -> RunStatus:
        """Read it from a run folder; writes nothing.

        Raises
        ------
        UserError
            When the folder is no run.
        """
        if found_manifest(folder) is None or not (folder / SCENARIO).exists():
            raise UserError(f"{folder}: no run. Give the folder that `bathyflash run -o` wrote")
        scenario = load_scenario(str(folder / SCENARIO), {})
        notes = {note.frame: note for note in read_notes(folder / JOURNAL)}
        pilot = pilot_of(folder)
        return cls(
            title=scenario.mission.title,
            frames=flight_plan(scenario).frame_count,
            done=len(notes),
            pilot=pilot,
            rate=None if pilot is None else recent_rate(list(notes.values())),
            has_products=(folder / "metrics.json").exists(),
            last_words=_last_line(folder / LOG),
        )

    @property
    def lines(self) -> list[str]:
        """It in words for the user."""
        state = "finished" if self.done >= self.frames and self.has_products else "stopped"
        if self.pilot is not None:
            state = f"flown by process {self.pilot.process} on {self.pilot.machine}"
        lines = [self.title, f"{self.done}/{self.frames} frames, {state}"]
        if self.rate:
            left = (self.frames - self.done) / self.rate
            lines.append(f"{self.rate:.2f} frames/s, {left:.0f} s left")
        return [*lines, f"last: {self.last_words}"] if self.last_words else lines


def recent_rate(notes: Sequence[Note]) -> float | None:
    """Return frames a second over the last 20 notes; None of fewer than two.

    Examples
    --------
    >>> notes = [Note(frame=i, sha256="", done=100.0 + 0.5 * i) for i in range(9)]
    >>> recent_rate(notes)
    2.0
    """
    times = sorted(note.done for note in notes)[-RECENT:]
    if len(times) < 2 or times[-1] <= times[0]:
        return None
    return (len(times) - 1) / (times[-1] - times[0])


def _last_line(log: Path) -> str:
    if not log.exists():
        return ""
    lines = log.read_text(encoding="utf-8").splitlines()
    return lines[-1] if lines else ""
