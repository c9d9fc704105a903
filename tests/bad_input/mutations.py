"""Small damage to files, by chance from a seed: to bytes, lines, fields."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable

import numpy as np

Damage = Callable[[bytes, np.random.Generator], bytes]

NUMBER = re.compile(rb"(?<![\w.#])[-+]?\d[\d.]*(?:[eE][-+]?\d+)?(?![\w.])")
WORDS = (
    *(b"nan", b"inf", b"-inf", b"1e308", b"-1e308", b"1e-308", b"1e999", b"0", b"-1", b""),
    *(b"999999999999999999999", b"1e18", b"12e", b"0x10", b"1_0", b"true", b'"10"', b"'10'"),
    *(b"[1.0]", b"{}", b"\x00", "١٢".encode(), "\u22121".encode(), b"1,5", b"\xff\xfe", b"null"),
)
PIECES = (
    *(b"\x00", b"\xff", "\ufeff".encode(), "é".encode(), "\u2028".encode(), b"\r", b"\x1b[2J"),
    *(b'"', b"'", b"{", b"}", b"[", b"]", b",", b"=", b"#", b"\\", b"/", b"-", b"\n\n"),
)
DOUBLES = (float("nan"), float("inf"), -float("inf"), 1e308, -1e308, 5e-324, 0.0, -1.0)


def flip(content: bytes, random: np.random.Generator) -> bytes:
    """One to four bits turned over."""
    changed = bytearray(content)
    for _ in range(int(random.integers(1, 5))):
        changed[_place(content, random)] ^= 1 << int(random.integers(8))
    return bytes(changed)


def cut(content: bytes, random: np.random.Generator) -> bytes:
    """The rest is missing."""
    return content[: _place(content, random)]


def lose(content: bytes, random: np.random.Generator) -> bytes:
    """A piece is missing."""
    start, end = sorted((_place(content, random), _place(content, random)))
    return content[:start] + content[min(end, start + 40) :]


def repeat(content: bytes, random: np.random.Generator) -> bytes:
    """A piece stands there twice."""
    start = _place(content, random)
    end = start + int(random.integers(1, 65))
    return content[:end] + content[start:]


def overwrite_double(content: bytes, random: np.random.Generator) -> bytes:
    """A double that is no sound number stands somewhere."""
    value = struct.pack("<d", DOUBLES[int(random.integers(len(DOUBLES)))])
    place = _place(content, random) // 8 * 8
    return content[:place] + value + content[place + 8 :]


def overwrite_count(content: bytes, random: np.random.Generator) -> bytes:
    """Four bytes in the first few hundred are all set, or none."""
    place = int(random.integers(min(len(content), 400)))
    return content[:place] + bytes([255 * int(random.integers(2))]) * 4 + content[place + 4 :]


def insert(content: bytes, random: np.random.Generator) -> bytes:
    """A sign that does not belong there."""
    place = _place(content, random)
    return content[:place] + PIECES[int(random.integers(len(PIECES)))] + content[place:]


def replace_number(content: bytes, random: np.random.Generator) -> bytes:
    """Something else in the place of a number."""
    found = list(NUMBER.finditer(content))
    if not found:
        return insert(content, random)
    chosen = found[int(random.integers(len(found)))]
    word = WORDS[int(random.integers(len(WORDS)))]
    return content[: chosen.start()] + word + content[chosen.end() :]


def negate_number(content: bytes, random: np.random.Generator) -> bytes:
    """A number with the other sign, or far larger."""
    found = list(NUMBER.finditer(content))
    if not found:
        return insert(content, random)
    chosen = found[int(random.integers(len(found)))]
    number = chosen[0]
    other = number[1:] if number.startswith(b"-") else b"-" + number
    word = other if random.random() < 0.5 else number + b"000"
    return content[: chosen.start()] + word + content[chosen.end() :]


def lose_line(content: bytes, random: np.random.Generator) -> bytes:
    """A line, in a scenario a key, is missing."""
    lines = content.splitlines(keepends=True)
    del lines[int(random.integers(len(lines)))]
    return b"".join(lines)


def repeat_line(content: bytes, random: np.random.Generator) -> bytes:
    """A line stands there twice."""
    lines = content.splitlines(keepends=True)
    number = int(random.integers(len(lines)))
    return b"".join([*lines[: number + 1], *lines[number:]])


def swap_lines(content: bytes, random: np.random.Generator) -> bytes:
    """Two lines have changed places."""
    lines = content.splitlines(keepends=True)
    one, other = (int(number) for number in random.integers(len(lines), size=2))
    lines[one], lines[other] = lines[other], lines[one]
    return b"".join(lines)


def lose_field(content: bytes, random: np.random.Generator) -> bytes:
    """A word between commas or spaces is missing."""
    found = list(re.finditer(rb"[^\s,]+[\s,]?", content))
    chosen = found[int(random.integers(len(found)))]
    return content[: chosen.start()] + content[chosen.end() :]


ANY: tuple[Damage, ...] = (flip, cut, lose, repeat, insert)
BINARY: tuple[Damage, ...] = (*ANY, overwrite_double, overwrite_count)
TEXT: tuple[Damage, ...] = (
    *(*ANY, replace_number, replace_number, replace_number, negate_number),
    *(lose_line, repeat_line, swap_lines, lose_field),
)


def mutant(content: bytes, *, seed: tuple[int, ...]) -> tuple[str, bytes]:
    """Return the name of some damage, and the content that has it; never the content as it was."""
    random = np.random.default_rng(seed)
    choice = BINARY if b"\x00" in content else TEXT
    while True:
        damage = choice[int(random.integers(len(choice)))]
        changed = damage(content, random)
        if changed != content:
            return damage.__name__, changed


def _place(content: bytes, random: np.random.Generator) -> int:
    return int(random.integers(len(content)))
