"""What a seabed, its map and its objects are made of: names, codes, reflectances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from survey.scenario.seabed_object_sections import Material
from survey.scenario.seabed_sections import ReefSeabed, SeabedSection
from terrain.substrate import (
    FIRST_OWN_CODE,
    LAST_CODE,
    UNLABELLED,
    Substrate,
    known_substrates,
)

UNSTATED_REFLECTANCE = 0.1
MOST_OWN_NAMES = LAST_CODE - FIRST_OWN_CODE + 1


def materials(seabed: SeabedSection) -> Iterator[tuple[str, Material]]:
    """Yield every part of a seabed that is made of something, with its place in the scenario."""
    yield "seabed", seabed
    classes = seabed.map.classes if seabed.map else []
    yield from ((f"seabed.map.classes.{i}", part) for i, part in enumerate(classes))
    yield from ((f"seabed.objects.{i}", part) for i, part in enumerate(seabed.objects))


def reef_material(seabed: ReefSeabed) -> Material:
    """Return what a reef is made of."""
    return Material(substrate=seabed.reef_substrate, reflectance=seabed.reef_reflectance)


def own_names(seabed: SeabedSection) -> list[str]:
    """Return the names of substrates that are the scenario's own, in the order of their codes."""
    named = [part.substrate for _, part in materials(seabed)]
    if isinstance(seabed, ReefSeabed):
        named.append(seabed.reef_substrate)
    return list(dict.fromkeys(name for name in named if name and name not in known_substrates()))


def substrate_of(part: Material, seabed: SeabedSection) -> Substrate:
    """Return the substrate of a part of a seabed; a stated reflectance comes before the table's."""
    name = part.substrate
    reflectance = stated_reflectance(part.model_dump())
    if name is None:
        return Substrate(code=UNLABELLED, name="", reflectance=reflectance)
    known = known_substrates()
    own = own_names(seabed)
    code = known[name].code if name in known else FIRST_OWN_CODE + own.index(name)
    return Substrate(code=code, name=name, reflectance=reflectance)


def stated_reflectance(table: Mapping[str, Any]) -> float:
    """Return the reflectance that a table states, its substrate has, or 0.1.

    Examples
    --------
    >>> stated_reflectance({"substrate": "sand", "reflectance": None})
    0.243
    """
    if table["reflectance"] is not None:
        return float(table["reflectance"])
    known = known_substrates().get(table["substrate"] or "")
    return UNSTATED_REFLECTANCE if known is None else known.reflectance


def fill_reflectances(table: dict[str, Any]) -> None:
    """Fill in the reflectances that follow from substrates, in the plain table of a seabed."""
    parts = [table, *table["objects"], *(table["map"]["classes"] if table["map"] else [])]
    for part in parts:
        part["reflectance"] = stated_reflectance(part)
    if "reef_substrate" in table:
        reef = {"substrate": table["reef_substrate"], "reflectance": table["reef_reflectance"]}
        table["reef_reflectance"] = stated_reflectance(reef)
