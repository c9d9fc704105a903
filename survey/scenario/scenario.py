"""A sound scenario, and variations of it."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, cast

from survey.scenario import sections
from survey.scenario.faults import Fault, ScenarioError
from survey.scenario.motion_sections import Motion, Navigation
from survey.scenario.rules import broken_rules
from survey.scenario.seabed_materials import fill_reflectances
from survey.scenario.seabed_sections import SeabedSection
from survey.scenario.sun import (
    air_extinction_per_m,
    stated_irradiance_w_m2_nm,
    water_reflectance,
)
from survey.scenario.surface_sections import Surface
from survey.scenario.times import gate_start_ns
from survey.scenario.toml_text import to_toml
from survey.scenario.validate import validate
from survey.scenario.water_sections import PetzoldWater, WaterSection


@dataclass(frozen=True, kw_only=True)
class Scenario:
    """The sections of a scenario file in the file's own units.

    `survey.scenario.components` turns them into parts in SI units and radians.

    Parameters
    ----------
    mission, flight, motion, navigation, laser, camera, receiver, detector : Section
        The section of that name, defaults filled in.
    water, surface, seabed, sun, transport, processing, run : Section
        The section of that name, defaults filled in.
    name : str
        The file's name as it stands in faults.
    folder : Path
        Folder from which files named in the scenario are reached.
    given : Mapping
        The tables as written, before defaults.
    """

    mission: sections.Mission
    flight: sections.Flight
    motion: Motion
    navigation: Navigation
    laser: sections.Laser
    camera: sections.Camera
    receiver: sections.Receiver
    detector: sections.Detector
    water: WaterSection
    surface: Surface
    seabed: SeabedSection
    sun: sections.Sun
    transport: sections.Transport
    processing: sections.Processing
    run: sections.Run
    name: str = field(compare=False)
    folder: Path = field(compare=False)
    given: Mapping[str, Any] = field(compare=False, repr=False)

    @classmethod
    def from_tables(cls, tables: Mapping[str, Any], *, name: str, folder: Path) -> Scenario:
        """Return the scenario that plain tables describe.

        Raises
        ------
        ScenarioError
            With every fault of the tables.
        """
        sound, faults = validate(tables)
        faults += broken_rules(sound, folder)
        if faults:
            raise ScenarioError(name, faults)
        return cls(name=name, folder=folder, given=tables, **cast("dict[str, Any]", sound))

    def replace(self, changes: Mapping[str, Any] | None = None, /, **more: Any) -> Scenario:
        """Return a checked variation.

        A dotted key changes one value, a section's name with a table changes the whole section,
        and the value None goes back to the default. As arguments, keys have two underscores in
        place of the dot.

        Parameters
        ----------
        changes : mapping, optional
            Values by dotted key, such as ``{"water.type": "clear"}``.
        **more
            Others, such as ``water__type="clear"``.

        Raises
        ------
        ScenarioError
            When the variation is not sound.

        Examples
        --------
        >>> from survey import load_scenario
        >>> wide = load_scenario("sandbar").replace(receiver__aperture_radius_m=0.01)
        >>> wide.receiver.aperture_radius_m
        0.01
        >>> wide.replace({"receiver.aperture_radius_m": 0.02}).receiver.aperture_radius_m
        0.02
        """
        named = {key.replace("__", "."): value for key, value in more.items()}
        tables = with_changes(self.given, {**(changes or {}), **named}, name=self.name)
        return Scenario.from_tables(tables, name=self.name, folder=self.folder)

    def to_toml(self, *, beside: Path | None = None) -> str:
        """Return the resolved scenario as TOML, with every default.

        Parameters
        ----------
        beside : Path, optional
            Folder in which the text will lie: the files that it names are then given relative to
            that folder, otherwise as they were written.
        """
        tables = self._tables()
        self._resolve(tables)
        if beside is not None:
            for table in _tables_with_a_file(tables):
                path = os.path.relpath(self.folder / table["file"], beside)
                table["file"] = Path(path).as_posix()
        return to_toml(tables)

    @property
    def files(self) -> list[str]:
        """The files that the scenario names, as they were written."""
        return [str(table["file"]) for table in _tables_with_a_file(self._tables())]

    def _tables(self) -> dict[str, Any]:
        names = [part.name for part in fields(self) if part.compare]
        return {name: getattr(self, name).model_dump() for name in names}

    def _resolve(self, tables: dict[str, Any]) -> None:
        """Fill in the defaults that follow from other sections."""
        _resolve_water(self.water, tables["water"])
        for layer, table in zip(self.water.layers, tables["water"]["layers"], strict=True):
            _resolve_water(layer, table)
        _default(tables["receiver"], "gate_start_ns", gate_start_ns(self.receiver, self.flight))
        _default(tables["processing"], "echo_gate_ns", self.laser.pulse_width_ns)
        self._resolve_sun(tables["sun"])
        fill_reflectances(tables["seabed"])

    def _resolve_sun(self, table: dict[str, Any]) -> None:
        """Fill in the numbers that no other key of the section says already."""
        if self.sun.spectrum == "stated":
            _default(table, "solar_irradiance_w_m2_nm", stated_irradiance_w_m2_nm(self.sun))
        if self.sun.water_light == "stated":
            _default(table, "water_reflectance", water_reflectance(self.sun, self.water))
        if self.sun.model == "layered":
            _default(table, "air_extinction_per_m", air_extinction_per_m(self.sun, self.flight))


def _resolve_water(water: sections.Section, table: dict[str, Any]) -> None:
    """Fill in the coefficients of a measured water."""
    if isinstance(water, PetzoldWater):
        from survey.optics.water import PAPER_COEFFICIENTS

        absorption, scattering = PAPER_COEFFICIENTS[water.type]
        _default(table, "absorption_per_m", absorption)
        _default(table, "scattering_per_m", scattering)


def _tables_with_a_file(value: Any) -> Iterator[dict[str, Any]]:
    """Yield every table, at any depth, that names a file."""
    if isinstance(value, dict):
        if value.get("file") is not None:
            yield value
        value = list(value.values())
    if isinstance(value, list):
        for inner in value:
            yield from _tables_with_a_file(inner)


def _default(table: dict[str, Any], key: str, value: float) -> None:
    if table[key] is None:
        table[key] = value


def with_changes(
    tables: Mapping[str, Any], changes: Mapping[str, Any], *, name: str
) -> dict[str, Any]:
    """Return a copy of plain tables with dotted keys changed.

    Examples
    --------
    >>> with_changes({"water": {"type": "clear"}}, {"water.type": "harbor"}, name="reef.toml")
    {'water': {'type': 'harbor'}}

    Raises
    ------
    ScenarioError
        When a dotted key leads through something that is not a table.
    """
    changed, faults = deepcopy(dict(tables)), []
    for key, value in changes.items():
        try:
            _change(changed, key.split("."), value)
        except (AttributeError, TypeError, IndexError, ValueError):
            faults.append(Fault(key, "there is no such place. Write section.key=value."))
    if faults:
        raise ScenarioError(name, faults)
    return changed


def _change(tables: dict[str, Any], steps: list[str], value: Any) -> None:
    place: Any = tables
    for step in steps[:-1]:
        place = place[int(step)] if isinstance(place, list) else place.setdefault(step, {})
    if isinstance(place, list):
        place[int(steps[-1])] = value
    elif value is None:
        place.pop(steps[-1], None)
    else:
        place[steps[-1]] = value
