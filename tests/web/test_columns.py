"""Packed columns come back as they went in, by a reader written from the format's words."""

from __future__ import annotations

import zlib
from base64 import b64decode
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some
from numpy.typing import NDArray

from viewer.web.columns import LARGEST, logarithmic, packed, rounded, start_of

NUMBERS = some.lists(some.integers(-LARGEST, LARGEST), max_size=40)


def unpacked(table: dict[str, Any]) -> dict[str, NDArray[np.int64]]:
    """Undo `packed`."""
    content = zlib.decompress(b64decode(table["data"]))
    found, start = {}, 0
    for column in table["columns"]:
        size = column["bytes"] * table["count"]
        planes = np.frombuffer(content[start : start + size], np.uint8)
        planes = planes.reshape(column["bytes"], table["count"]).astype(np.int64)
        zigzag = sum(plane << (8 * k) for k, plane in enumerate(planes))
        found[column["name"]] = np.cumsum((zigzag >> 1) ^ -(zigzag & 1))
        start += size
    return found


@settings(max_examples=40)
@given(NUMBERS)
def test_any_whole_numbers_come_back(values: list[int]) -> None:
    table = packed({"a": np.array(values, np.int64), "b": np.zeros(len(values), np.uint8)})
    np.testing.assert_array_equal(unpacked(table)["a"], values)
    assert not unpacked(table)["b"].any()


def test_a_number_that_is_too_large_is_refused() -> None:
    with pytest.raises(ValueError, match="x: 2147483648 does not fit"):
        packed({"x": np.array([0, 2**31])})


def test_columns_of_unequal_length_are_refused() -> None:
    with pytest.raises(ValueError, match=r"lengths \[1, 2\]"):
        packed({"x": np.array([0]), "y": np.array([0, 1])})


def test_rounding_is_within_half_a_step_and_keeps_nan() -> None:
    values = np.append(np.random.default_rng(0).normal(-3.0, 5.0, 500), np.nan)
    codes = rounded(values, 0.005)
    back = np.where(codes == 0, np.nan, (start_of(values, 0.005) + codes - 1) * 0.005)
    np.testing.assert_allclose(back, values, atol=0.0025 + 1e-9)
    assert codes.min() == 0
    assert (codes == 0).sum() == 1


def test_logarithms_are_within_half_a_ratio() -> None:
    values = np.geomspace(1e-4, 1e6, 400)
    codes = logarithmic(values, least=1e-4, step=0.02)
    np.testing.assert_allclose(1e-4 * 1.02 ** (codes - 1), values, rtol=0.0101)
    assert logarithmic(np.array([np.nan, 0.0, -1.0]), least=1e-4, step=0.02).tolist() == [0, 0, 0]
