"""A first look at a mesh in text, for trimesh leaves out in silence what it cannot read."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from terrain.foreign.faults import ReaderError
from terrain.foreign.text_table import few, is_number

Row = tuple[int, list[str]]
Columns = Sequence[bool]
"""Whether each column is a list: a count, and so many vertices of a face."""

OBJ_STATEMENTS = {"v", "vt", "vn", "vp", "f", "l", "p", "g", "o", "s", "mg", "usemtl", "mtllib"}
FEWEST_CORNERS = 3


def require_whole_text(path: Path) -> None:
    """Refuse a text mesh (OBJ, OFF, PLY) with rows that are none, or more or fewer than announced.

    Raises
    ------
    ReaderError
        With the first faults.
    """
    look = {".obj": _obj_faults, ".off": _off_faults, ".ply": _ply_faults}.get(path.suffix.lower())
    if look is None:
        return
    content = path.read_bytes()
    if path.suffix.lower() == ".ply" and b"\nformat ascii" not in content[:400].replace(b"\r", b""):
        return
    faults = list(look(content.decode("utf-8", "replace")))
    if faults:
        raise ReaderError(*few(faults))


def _rows(text: str) -> list[Row]:
    """Return line numbers and words of the rows, without comments."""
    rows = ((number, line.split("#", 1)[0].split()) for number, line in enumerate(_lines(text), 1))
    return [row for row in rows if row[1]]


def _lines(text: str) -> list[str]:
    return text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def _obj_faults(text: str) -> Iterator[str]:
    rows = _rows(text.replace("\\\r\n", " ").replace("\\\n", " "))
    vertices = sum(words[0] == "v" for _, words in rows)
    for line, (keyword, *words) in rows:
        if keyword not in OBJ_STATEMENTS:
            yield f"line {line}: {keyword[:40]!r} is no statement of OBJ. leave it out"
        elif keyword == "v" and (len(words) < 3 or not all(map(is_number, words))):
            yield f"line {line}: not a vertex. give it three numbers"
        elif keyword == "f":
            yield from _obj_face_faults(line, [word.split("/")[0] for word in words], vertices)


def _obj_face_faults(line: int, words: list[str], vertices: int) -> Iterator[str]:
    if len(words) < FEWEST_CORNERS or not all(word.lstrip("-").isdecimal() for word in words):
        yield f"line {line}: not a face. give it three vertices or more"
        return
    for index in map(int, words):
        if index == 0:
            yield f"line {line}: index 0, but vertices count from 1"
        elif abs(index) > vertices:
            yield f"line {line}: index {index}, but there are {vertices} vertices"


def _off_faults(text: str) -> Iterator[str]:
    rows = _rows(text)
    words = [word for _, row in rows[:2] for word in row][1:4]
    if not rows or rows[0][1][0].upper() not in ("OFF", "COFF") or len(words) < 3:
        yield "line 1: not the header of an OFF file. write OFF, and the counts in the next line"
        return
    if not all(word.isdecimal() for word in words):
        yield f"line {rows[0][0]}: {' '.join(words)[:40]!r} are no counts. write whole numbers"
        return
    body = rows[1:] if len(rows[0][1]) >= 4 else rows[2:]
    vertices, faces = int(words[0]), int(words[1])
    yield from _body_faults(body, [(vertices, (False,) * 3), (faces, (True,))], longer=True)


def _ply_faults(text: str) -> Iterator[str]:
    lines = _lines(text)
    header = [line.split() for line in lines]
    end = next((number for number, words in enumerate(header) if words == ["end_header"]), None)
    if end is None:
        yield "header: it has no end. write end_header after it"
        return
    elements: list[tuple[int, list[bool]]] = []
    for words in header[:end]:
        if words[:1] == ["element"]:
            if len(words) != 3 or not words[2].isdecimal():
                yield f"header: {' '.join(words)[:60]!r} announces nothing. give a name and a count"
                return
            elements.append((int(words[2]), []))
        elif words[:1] == ["property"] and elements:
            elements[-1][1].append(words[1:2] == ["list"])
    body = [(number, words) for number, words in enumerate(header[end + 1 :], end + 2) if words]
    yield from _body_faults(body, elements)


def _body_faults(
    rows: list[Row], elements: Sequence[tuple[int, Columns]], *, longer: bool = False
) -> Iterator[str]:
    """Yield the rows that do not hold what elements, counts with columns, announce."""
    announced = sum(count for count, _ in elements)
    if len(rows) != announced:
        yield f"rows: {announced} announced, {len(rows)} there. fetch or export it again"
        return
    first = 0
    for count, columns in elements:
        for line, words in rows[first : first + count]:
            if not _fits(words, columns, longer=longer):
                yield f"line {line}: {' '.join(words)[:40]!r} does not hold what is announced"
        first += count


def _fits(words: list[str], columns: Columns, *, longer: bool) -> bool:
    place = 0
    for is_list in columns:
        if is_list:
            count = words[place] if place < len(words) else ""
            if not count.isdecimal() or int(count) < FEWEST_CORNERS:
                return False
            place += int(count)
        place += 1
    enough = len(words) >= place if longer else len(words) == place
    return enough and all(map(is_number, words))
