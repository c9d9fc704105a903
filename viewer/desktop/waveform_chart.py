"""The waveform of a picked pixel; its frame is flown again while the window stays alive."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor

from survey.errors import UserError
from survey.labelled.flown_run import FlownRun
from survey.labelled.picked import PickedPixels
from survey.labelled.picture import waveform_figure
from viewer.desktop.pictures import Picture, picture_of

SIZE = (7.6, 5.0)
Address = tuple[int, int, int]


class WaveformCharts:
    """Charts of pixels' waveforms, one at a time, made beside the window's own work.

    Parameters
    ----------
    run : FlownRun, optional
        Without one no chart can be made.
    """

    def __init__(self, run: FlownRun | None) -> None:
        self._pixels = PickedPixels(run) if run else None
        self._worker = ThreadPoolExecutor(max_workers=1)
        self._waiting: Future[Picture] | None = None

    def ask(self, address: Address) -> None:
        """Have the chart of frame, row and column made; one asked for before is forgotten."""
        if self._waiting is not None:
            self._waiting.cancel()
        self._waiting = self._worker.submit(self.chart, address)

    def answer(self) -> Picture | str | None:
        """Return the chart asked for, or why there is none; None while it is being made."""
        if self._waiting is None or not self._waiting.done():
            return None
        asked, self._waiting = self._waiting, None
        try:
            return asked.result()
        except (OSError, ValueError, RuntimeError) as fault:
            return f"No waveform: {fault}"

    def chart(self, address: Address) -> Picture:
        """Fly a frame again and return the chart of one of its pixels.

        Raises
        ------
        OtherRunError
            When the frame flown again is not the run's own.
        UserError
            When the run has no such pixel, or frames cannot be flown.
        """
        if self._pixels is None:
            raise UserError("the run's frames are not here. Finish it with: bathyflash run")
        frame, row, column = address
        pixel = self._pixels.waveform(frame=frame, row=row, column=column)
        return picture_of(waveform_figure(pixel, size=SIZE))

    def forget(self) -> None:
        """Drop what was asked for, and wait for nothing."""
        if self._waiting is not None:
            self._waiting.cancel()
        self._waiting = None

    def close(self) -> None:
        """End the worker when its present work is done."""
        self._worker.shutdown(wait=False, cancel_futures=True)
