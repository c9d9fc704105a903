"""What is wrong with a run or a cloud that is to be scored."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from survey.errors import UserError


class ScoreError(UserError):
    """A cloud that cannot be scored, or a run that cannot judge it; a line a fault."""

    def __init__(self, faults: Sequence[str], *, only_missing_files: bool = False) -> None:
        self.faults = tuple(faults)
        self.only_missing_files = only_missing_files
        super().__init__("\n".join(faults))


@contextmanager
def gathered(faults: list[str]) -> Iterator[None]:
    """Put the lines of a fault into a list instead of raising it."""
    try:
        yield
    except ValueError as fault:
        faults += str(fault).splitlines()
