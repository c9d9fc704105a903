"""Errors that the user can mend; each is one line a fault."""

from __future__ import annotations


class UserError(ValueError):
    """Something in the input or on the machine stands in the way."""


class OtherRunError(UserError):
    """The run folder belongs to another scenario or to other code."""


class FrameError(RuntimeError):
    """A frame that cannot be flown."""
