"""The keys of the window: one table, which is also the help on the screen."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from enum import Enum, auto

import numpy as np

from viewer.desktop.state import Layer, ViewState

TURN = np.radians(5.0)
MOVE = 60.0
"""Pixels."""
ZOOM = 1.2


class Command(Enum):
    """What needs the window itself."""

    PICK_MIDDLE = auto()
    SAVE_PICTURE = auto()
    QUIT = auto()


Action = Callable[[ViewState], ViewState] | Command


@dataclass(frozen=True, kw_only=True)
class Key:
    """One or a few keys of a kind.

    Parameters
    ----------
    shown, words : str
        As the help lists them.
    actions : dict
        What each key does, by VTK's name of it.
    """

    shown: str
    words: str
    actions: dict[str, Action]


def _colour(attribute: str) -> Action:
    return lambda state: state.coloured_by(attribute)


def _turn(around: float, upwards: float) -> Action:
    return lambda state: state.seen_from(state.orbit.turned(TURN * around, TURN * upwards))


def _move(right: float, up: float) -> Action:
    return lambda state: state.seen_from(state.orbit.moved(MOVE * right, MOVE * up))


def _zoom(factor: float) -> Action:
    return lambda state: state.seen_from(state.orbit.nearer(factor))


def _switch(layer: Layer) -> Action:
    return lambda state: state.toggled(layer)


def _step(count: int) -> Action:
    return lambda state: state.stepped(count)


def _stretch(step: int) -> Action:
    return lambda state: state.stretched(step)


KEYS = (
    Key(
        shown="1 2 3 4 5",
        words="colour by depth, error, TVU, THU, signal-to-noise ratio",
        actions={
            digit: _colour(name)
            for digit, name in zip("12345", ("depth", "error", "tvu", "thu", "snr"), strict=True)
        },
    ),
    Key(
        shown="6 7 8 9 0",
        words="by class, cause of error, substrate, frame, line",
        actions={
            digit: _colour(name)
            for digit, name in zip(
                "67890", ("class", "cause", "substrate", "frame", "line"), strict=True
            )
        },
    ),
    Key(shown="o", words="by outcome: the cause of holes", actions={"o": _colour("outcome")}),
    Key(
        shown="b m s",
        words="bottom points, mesh of them, true seabed",
        actions={
            "b": _switch(Layer.BOTTOM),
            "m": _switch(Layer.MESH),
            "s": _switch(Layer.SEABED),
        },
    ),
    Key(
        shown="w u",
        words="water surface, pixels without a bottom",
        actions={"w": _switch(Layer.SURFACE), "u": _switch(Layer.OTHER)},
    ),
    Key(
        shown="l k c",
        words="flight lines, all footprints, light of the frame",
        actions={
            "l": _switch(Layer.FLIGHT),
            "k": _switch(Layer.FOOTPRINTS),
            "c": _switch(Layer.LIGHT),
        },
    ),
    Key(
        shown="[ ]  { }",
        words="frame back, on; ten frames",
        actions={
            "bracketleft": _step(-1),
            "bracketright": _step(1),
            "braceleft": _step(-10),
            "braceright": _step(10),
        },
    ),
    Key(
        shown="space",
        words="fly the mission, stop",
        actions={"space": ViewState.started_or_stopped},
    ),
    Key(
        shown="f",
        words="points of all frames, up to this one, of this one",
        actions={"f": ViewState.next_reach},
    ),
    Key(
        shown="h H",
        words="heights multiplied less, more",
        actions={"h": _stretch(-1), "H": _stretch(1)},
    ),
    Key(
        shown="click",
        words="a point: its numbers and waveform; Enter: nearest the middle",
        actions={"Return": Command.PICK_MIDDLE, "KP_Enter": Command.PICK_MIDDLE},
    ),
    Key(
        shown="d",
        words="draw a profile: click its two ends",
        actions={"d": ViewState.began_profile},
    ),
    Key(
        shown="drag, arrows",
        words="turn the view",
        actions={
            "Left": _turn(-1.0, 0.0),
            "Right": _turn(1.0, 0.0),
            "Up": _turn(0.0, 1.0),
            "Down": _turn(0.0, -1.0),
        },
    ),
    Key(
        shown="Shift with them",
        words="move it",
        actions={
            "Shift+Left": _move(-1.0, 0.0),
            "Shift+Right": _move(1.0, 0.0),
            "Shift+Up": _move(0.0, 1.0),
            "Shift+Down": _move(0.0, -1.0),
        },
    ),
    Key(
        shown="wheel, + -",
        words="nearer, further",
        actions={
            "plus": _zoom(ZOOM),
            "equal": _zoom(ZOOM),
            "KP_Add": _zoom(ZOOM),
            "minus": _zoom(1.0 / ZOOM),
            "KP_Subtract": _zoom(1.0 / ZOOM),
        },
    ),
    Key(
        shown="t r",
        words="from above, as at first",
        actions={
            "t": lambda state: state.seen_from(state.orbit.from_above()),
            "r": lambda state: state.seen_from(state.home),
        },
    ),
    Key(shown="p", words="save a picture", actions={"p": Command.SAVE_PICTURE}),
    Key(
        shown="? F1",
        words="these keys",
        actions=dict.fromkeys(
            ("question", "F1"), lambda state: replace(state, help=not state.help)
        ),
    ),
    Key(shown="Esc", words="close what is open", actions={"Escape": ViewState.closed}),
    Key(shown="q", words="leave", actions={"q": Command.QUIT}),
)

ACTIONS: dict[str, Action] = {name: action for key in KEYS for name, action in key.actions.items()}


def action_of(name: str, *, shift: bool) -> Action | None:
    """Return what a key does, with Shift where that is another; None for a key without a use.

    Examples
    --------
    >>> action_of("q", shift=False), action_of("F9", shift=False)
    (<Command.QUIT: 3>, None)
    """
    return ACTIONS.get(f"Shift+{name}" if shift else name) or ACTIONS.get(name)


def help_text(keys: Iterable[Key] = KEYS) -> str:
    """Return the keys and their words in two columns."""
    return "\n".join(f"{key.shown:16} {key.words}" for key in keys)
