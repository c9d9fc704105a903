"""The waveform of one pixel of a run, for whoever points at it."""

from __future__ import annotations

import re
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

from survey.errors import UserError
from survey.labelled.attributes import scenario_attributes
from survey.labelled.dataset import dataset_of, tags_of, with_tags
from survey.labelled.flown_run import FlownRun
from survey.mission import observe
from survey.preparation import Mission, prepare

if TYPE_CHECKING:
    import xarray

FRAMES_REMEMBERED = 4


class PickedPixels:
    """Gives single pixels of a run; the frames last asked for are remembered.

    The first pixel takes as long as a mission's preparation and one flash, another of a new frame
    one flash, another of the same frame no time.

    Parameters
    ----------
    run : FlownRun
    """

    def __init__(self, run: FlownRun) -> None:
        self.run = run
        self.frame = lru_cache(maxsize=FRAMES_REMEMBERED)(self._frame)

    @cached_property
    def mission(self) -> Mission:
        """The run's mission, built when it is first needed."""
        return with_tags(prepare(self.run.scenario))

    def waveform(self, *, frame: int, row: int, column: int) -> xarray.Dataset:
        """Return one pixel of `labelled_waveforms`: what had pixels has none of these dimensions.

        Raises
        ------
        OtherRunError
            When the frame flown again is not the run's own.
        UserError
            When the run has no such pixel.
        """
        camera = self.run.scenario.camera
        if not (0 <= row < camera.rows and 0 <= column < camera.columns):
            raise UserError(
                f"{self.run.folder}: no pixel in row {row}, column {column}. "
                f"The camera has rows 0:{camera.rows} and columns 0:{camera.columns}"
            )
        self.run.chosen(range(frame, frame + 1))
        whole = self.frame(frame)
        picked = whole.isel(frame=0, row=row, column=column)
        if "tag" in whole.dims:
            picked = picked.isel(tag=tags_of(whole, frame=0, row=row, column=column))
        return picked

    def _frame(self, index: int) -> xarray.Dataset:
        seen = observe(self.mission, self.mission.frames[index])
        self.run.require_same(index, seen.result)
        attributes = {**scenario_attributes(self.run.scenario), **self.run.identity}
        return dataset_of(self.mission, seen).assign_attrs(attributes)


def parse_pixel(text: str) -> tuple[int, int, int]:
    """Return frame, row and column of ``FRAME,ROW,COLUMN``.

    Raises
    ------
    UserError
        When the text is something else.

    Examples
    --------
    >>> parse_pixel("3,16,32")
    (3, 16, 32)
    """
    match = re.fullmatch(r"\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*", text)
    if match is None:
        raise UserError(f"--pixel {text}: not a pixel. Write FRAME,ROW,COLUMN, such as 3,16,32")
    return int(match[1]), int(match[2]), int(match[3])
