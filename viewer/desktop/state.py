"""What the window shows, as a plain object; keys and mouse make a new one of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

from viewer.desktop.orbit import Orbit
from viewer.view import EXAGGERATIONS

Place = tuple[float, float, float]


class Layer(StrEnum):
    """What can be switched on and off."""

    BOTTOM = "bottom points"
    MESH = "bottom as a mesh"
    SEABED = "true seabed"
    SURFACE = "sea surface"
    OTHER = "pixels without a bottom"
    FLIGHT = "flight lines"
    FOOTPRINTS = "footprints of all frames"
    LIGHT = "light of the frame"


class Reach(StrEnum):
    """Of which frames points are shown."""

    ALL = "all frames"
    SO_FAR = "frames up to this one"
    ONE = "this frame alone"


@dataclass(frozen=True, kw_only=True)
class Pick:
    """A point that was clicked: its cloud, its number there, its place to scale [m], its flash."""

    layer: Layer
    index: int
    place: Place
    flash: int


@dataclass(frozen=True, kw_only=True)
class ViewState:
    """What is shown, and from where.

    Parameters
    ----------
    home, orbit : Orbit
        Where the eye is at first, and now.
    frames : int
        How many flashes can be stepped through.
    exaggeration : float
        Factor for heights of sea and bottom above the water level.
    attribute : str
        What points are coloured by.
    frame : int
        Place of the flash shown, in the order of flight.
    reach : Reach
    playing : bool
        Whether the flight goes on by itself.
    layers : frozenset of Layer
        Those that are shown.
    picked : Pick, optional
        Whose numbers and waveform are shown.
    measuring : bool
        Whether clicks are ends of a profile.
    ends : tuple of Place
        Ends of the profile, at most two [m, to scale].
    help : bool
        Whether the keys are listed.
    """

    home: Orbit
    orbit: Orbit
    frames: int
    exaggeration: float
    attribute: str = "depth"
    frame: int = 0
    reach: Reach = Reach.ALL
    playing: bool = False
    layers: frozenset[Layer] = frozenset({Layer.BOTTOM, Layer.SURFACE, Layer.FLIGHT, Layer.LIGHT})
    picked: Pick | None = None
    measuring: bool = False
    ends: tuple[Place, ...] = ()
    help: bool = False

    def coloured_by(self, attribute: str) -> ViewState:
        """Return it coloured by an attribute."""
        return replace(self, attribute=attribute)

    def seen_from(self, orbit: Orbit) -> ViewState:
        """Return it seen from an orbit."""
        return replace(self, orbit=orbit)

    def stretched(self, step: int) -> ViewState:
        """Return it with heights multiplied by the next larger (1) or smaller (-1) factor."""
        place = EXAGGERATIONS.index(self.exaggeration) + step
        factor = EXAGGERATIONS[min(max(place, 0), len(EXAGGERATIONS) - 1)]
        return replace(self, exaggeration=factor)

    def at_frame(self, frame: int) -> ViewState:
        """Return it at a flash; beyond the ends at the end."""
        return replace(self, frame=min(max(frame, 0), self.frames - 1))

    def stepped(self, step: int) -> ViewState:
        """Return it some flashes on, standing still."""
        return replace(self.at_frame(self.frame + step), playing=False)

    def flown_on(self) -> ViewState:
        """Return it one flash on while it plays; it stops at the last."""
        on = self.at_frame(self.frame + 1)
        return replace(on, playing=on.frame < self.frames - 1)

    def started_or_stopped(self) -> ViewState:
        """Return it playing, from the start if it was at the end; or standing still."""
        if self.playing:
            return replace(self, playing=False)
        frame = 0 if self.frame == self.frames - 1 else self.frame
        reach = Reach.SO_FAR if self.reach is Reach.ALL else self.reach
        return replace(self, playing=True, frame=frame, reach=reach)

    def next_reach(self) -> ViewState:
        """Return it with the points of other frames."""
        kinds = list(Reach)
        return replace(self, reach=kinds[(kinds.index(self.reach) + 1) % len(kinds)])

    def toggled(self, layer: Layer) -> ViewState:
        """Return it with a layer switched on or off."""
        return replace(self, layers=self.layers ^ {layer})

    def began_profile(self) -> ViewState:
        """Return it waiting for the ends of a profile, or no longer waiting."""
        return replace(self, measuring=not self.measuring, ends=())

    def clicked(self, pick: Pick) -> ViewState:
        """Return it with a point picked: at its flash for its waveform, or as a profile's end."""
        if not self.measuring:
            return replace(self.at_frame(pick.flash), picked=pick, ends=(), playing=False)
        ends = (*self.ends, pick.place)
        return replace(self, ends=ends, measuring=len(ends) < 2, picked=None)

    def closed(self) -> ViewState:
        """Return it without picks, profile and help."""
        return replace(self, picked=None, measuring=False, ends=(), help=False)
