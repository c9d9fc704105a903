"""Rules that bind the keys of a seabed together."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from survey.scenario import seabed_sections as kinds
from survey.scenario.faults import Fault, did_you_mean, missing_file
from survey.scenario.seabed_materials import MOST_OWN_NAMES, materials, own_names, reef_material
from survey.scenario.seabed_object_sections import Boulders, Material
from survey.scenario.seabed_sections import SeabedSection
from survey.scenario.sections import Laser, Section
from terrain.extent import MOST_BOULDERS, MOST_CELLS
from terrain.substrate import known_substrates

TABLE_WAVELENGTH_NM = 532.0
TABLE_REACHES_NM = 10.0


def channel_is_deeper(seabed: SeabedSection) -> Iterator[Fault]:
    """A channel lies below the bed beside it."""
    if isinstance(seabed, kinds.ChannelSeabed) and seabed.channel_depth_m <= seabed.depth_m:
        yield Fault(
            "seabed.channel_depth_m",
            f"{seabed.channel_depth_m:g} is not deeper than depth_m {seabed.depth_m:g}. "
            "Deepen the channel.",
        )


def reef_is_shallower(seabed: SeabedSection) -> Iterator[Fault]:
    """A reef stands above the bed beside it."""
    if isinstance(seabed, kinds.ReefSeabed) and seabed.reef_depth_m >= seabed.depth_m:
        yield Fault(
            "seabed.reef_depth_m",
            f"{seabed.reef_depth_m:g} is not shallower than depth_m {seabed.depth_m:g}. "
            "Raise the reef.",
        )


def ripples_are_resolved(seabed: SeabedSection) -> Iterator[Fault]:
    """Cells are small enough to show a ripple."""
    if not isinstance(seabed, kinds.RipplesSeabed):
        return
    from terrain.bedforms import widest_ripple_spacing

    widest = widest_ripple_spacing(wavelength=seabed.wavelength_m, asymmetry=seabed.asymmetry)
    if seabed.spacing_m > widest:
        yield Fault(
            "seabed.spacing_m",
            f"{seabed.spacing_m:g} does not show ripples of {seabed.wavelength_m:g} m. "
            f"Take {widest:.3g} at most.",
        )


def boulders_ascend(seabed: SeabedSection) -> Iterator[Fault]:
    """The diameters of a boulder field ascend."""
    for number, part in enumerate(seabed.objects):
        if not isinstance(part, Boulders):
            continue
        least, mean, largest = part.least_diameter_m, part.mean_diameter_m, part.largest_diameter_m
        if not least < mean < largest:
            yield Fault(
                f"seabed.objects.{number}.mean_diameter_m",
                f"{mean:g} does not lie between the least {least:g} and the largest {largest:g}.",
            )


def boulders_fit_into_memory(seabed: SeabedSection) -> Iterator[Fault]:
    """A field holds no more boulders than a mesh can."""
    for number, part in enumerate(seabed.objects):
        if isinstance(part, Boulders):
            expected = part.length_m * part.width_m * part.density_per_m2
            if expected > MOST_BOULDERS:
                yield Fault(
                    f"seabed.objects.{number}.density_per_m2",
                    f"{expected:.3g} boulders are expected, more than {MOST_BOULDERS:,}. Take a "
                    "smaller field or density.",
                )


def cells_fit_into_memory(seabed: SeabedSection) -> Iterator[Fault]:
    """A made seabed has no more cells than a mesh can, counted over its margins alone."""
    if not isinstance(seabed, kinds.MadeSeabed):
        return
    if isinstance(seabed, kinds.PlaneSeabed | kinds.SlopeSeabed) and seabed.roughness_rms_m == 0.0:
        return
    cells = (2.0 * seabed.margin_m / seabed.spacing_m) ** 2
    if cells > MOST_CELLS:
        yield Fault(
            "seabed.spacing_m",
            f"{seabed.spacing_m:g} m and margin_m {seabed.margin_m:g} make {cells:.3g} cells, more "
            f"than {MOST_CELLS:,}. Widen the spacing or take a smaller margin.",
        )


def substrates_are_known(seabed: SeabedSection, laser: Laser) -> Iterator[Fault]:
    """Every substrate is in the table, which holds at 532 nm, or has a reflectance of its own."""
    parts = dict(materials(seabed))
    if isinstance(seabed, kinds.ReefSeabed):
        parts["seabed.reef"] = reef_material(seabed)
    for place, part in parts.items():
        if part.reflectance is None:
            yield from _table_faults(place, part, laser)
    if len(own_names(seabed)) > MOST_OWN_NAMES:
        yield Fault("seabed", f"more than {MOST_OWN_NAMES} own names of substrates. Merge some.")


def _table_faults(place: str, part: Material, laser: Laser) -> Iterator[Fault]:
    key = "seabed.reef_substrate" if place == "seabed.reef" else f"{place}.substrate"
    name, known = part.substrate, known_substrates()
    if name is None:
        if isinstance(part, kinds.MapClass):
            yield Fault(key, "missing. Name a substrate or state a reflectance.")
    elif name not in known:
        yield Fault(
            key,
            f"'{name}' is not one of {', '.join(known)}.{did_you_mean(name, known)} "
            "A name of your own needs its reflectance.",
        )
    elif abs(laser.wavelength_nm - TABLE_WAVELENGTH_NM) > TABLE_REACHES_NM:
        yield Fault(
            key,
            f"the reflectance of {name} is known at {TABLE_WAVELENGTH_NM:g} nm, not at "
            f"{laser.wavelength_nm:g}. State the reflectance.",
        )


def map_values_differ(seabed: SeabedSection) -> Iterator[Fault]:
    """Every number of a map stands for one thing."""
    seen: set[int] = set()
    for number, part in enumerate(seabed.map.classes if seabed.map else []):
        if part.value in seen:
            yield Fault(f"seabed.map.classes.{number}.value", f"{part.value} stands there already.")
        seen.add(part.value)


def files_exist(seabed: SeabedSection, folder: Path) -> Iterator[Fault]:
    """Every file that the seabed names is there."""
    named: dict[str, Section | None] = {"seabed.file": seabed, "seabed.map.file": seabed.map}
    named |= {f"seabed.objects.{number}.file": part for number, part in enumerate(seabed.objects)}
    for place, part in named.items():
        file = getattr(part, "file", None)
        if file is not None:
            yield from missing_file(place, file, folder)


SEABED_RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    channel_is_deeper,
    reef_is_shallower,
    ripples_are_resolved,
    boulders_ascend,
    boulders_fit_into_memory,
    cells_fit_into_memory,
    substrates_are_known,
    map_values_differ,
    files_exist,
)
