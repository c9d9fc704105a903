"""Which pixels of the camera are taken: a lattice, so that neighbours stay neighbours."""

from __future__ import annotations

import re
from dataclasses import dataclass

from survey.errors import UserError


@dataclass(frozen=True, kw_only=True)
class Pixels:
    """Every so-manieth row and column of a part of the camera.

    Parameters
    ----------
    rows, columns : range
    """

    rows: range
    columns: range

    @property
    def shape(self) -> tuple[int, int]:
        """How many rows and columns."""
        return len(self.rows), len(self.columns)

    @property
    def index(self) -> tuple[slice, slice]:
        """Takes them from an array (rows, columns, ...)."""
        rows, columns = (
            slice(part.start, part.stop, part.step) for part in (self.rows, self.columns)
        )
        return rows, columns

    @classmethod
    def every(cls, step: int, shape: tuple[int, int]) -> Pixels:
        """Return one pixel in ``step`` x ``step``; with 8 those that runs keep as ``sampled``.

        Raises
        ------
        UserError
            When that leaves no pixel.

        Examples
        --------
        >>> Pixels.every(8, (8, 16))
        Pixels(rows=range(4, 8, 8), columns=range(4, 16, 8))
        """
        rows, columns = (range(step // 2, size, step) for size in shape)
        if not rows or not columns:
            raise UserError(
                f"--every {step}: leaves no pixel of {shape[0]} rows and {shape[1]} columns. "
                f"Take at most {2 * min(shape) - 1}"
            )
        return cls(rows=rows, columns=columns)

    @classmethod
    def parse(cls, text: str, shape: tuple[int, int]) -> Pixels:
        """Return the pixels of ``A:B,C:D``, rows A to B and columns C to D, B and D excluded.

        Raises
        ------
        UserError
            When the text is no such part of a camera of this shape.

        Examples
        --------
        >>> Pixels.parse("8:24,:16", (32, 64))
        Pixels(rows=range(8, 24), columns=range(0, 16))
        """
        parts = text.split(",")
        ranges = [_range(part, size) for part, size in zip(parts, shape, strict=False)]
        if len(parts) != 2 or None in ranges:
            raise UserError(
                f"--pixels {text}: not rows and columns of the camera, which has rows "
                f"0:{shape[0]} and columns 0:{shape[1]}. Write A:B,C:D, such as 8:24,16:48"
            )
        rows, columns = (part for part in ranges if part is not None)
        return cls(rows=rows, columns=columns)


def _range(text: str, size: int) -> range | None:
    match = re.fullmatch(r"(\d*):(\d*)", text.strip())
    if match is None:
        return None
    found = range(int(match[1] or 0), int(match[2] or size))
    return found if found and found.stop <= size else None
