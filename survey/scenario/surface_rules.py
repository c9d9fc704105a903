"""Rules that bind the keys of the sea together, and to the camera."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import pi, tanh

from survey.scenario.faults import Fault
from survey.scenario.sections import Camera, Flight
from survey.scenario.surface_parts import resolution, wave_depth, wind_sea
from survey.scenario.surface_sections import Surface

MOST_NODES = 4096
STEEPEST = 0.142  # Miche (1944): height over length at which waves break


def wind_makes_the_waves(surface: Surface) -> Iterator[Fault]:
    """A spectrum has the keys that it needs, and a wind."""
    if surface.waves is None:
        return
    spectrum, fetch = surface.waves.spectrum, surface.waves.fetch_km
    if spectrum == "jonswap" and fetch is None:
        yield Fault("surface.waves.fetch_km", 'missing. It goes with spectrum = "jonswap".')
    if spectrum != "jonswap" and fetch is not None:
        yield Fault(
            "surface.waves.fetch_km",
            f'spectrum = "{spectrum}" has no use for it. Take "jonswap" or leave it out.',
        )
    if surface.wind_speed_m_s == 0.0:
        yield Fault("surface.waves", "no wind, no waves of it. Give wind_speed_m_s or take swell.")


def waves_fit_into_the_patch(surface: Surface) -> Iterator[Fault]:
    """The longest waves fit into what repeats itself, and the shortest into memory."""
    if surface.waves is None or surface.wind_speed_m_s == 0.0:
        return
    from terrain.waves.field import NODES_PER_WAVE, require_room

    patch, shortest = surface.waves.patch_m, surface.waves.shortest_m
    sea = wind_sea(surface)
    assert sea is not None
    try:
        require_room(sea, depth=wave_depth(surface), patch=patch)
    except ValueError as fault:
        text = str(fault).removeprefix("waves: ").replace(". enlarge", ". Enlarge")
        yield Fault("surface.waves.patch_m", f"{text}.")
    if NODES_PER_WAVE * patch > MOST_NODES * shortest:
        yield Fault(
            "surface.waves.shortest_m",
            f"waves of {shortest:g} m on a patch of {patch:g} m take more than {MOST_NODES} nodes "
            f"a side. Take {NODES_PER_WAVE * patch / MOST_NODES:g} m or a smaller patch.",
        )


def frame_fits_into_the_patch(surface: Surface, camera: Camera, flight: Flight) -> Iterator[Fault]:
    """No wave is seen twice in a frame."""
    if surface.waves is None:
        return
    tangent = camera.pixel_footprint_m / camera.design_range_m
    side = max(camera.rows, camera.columns) * tangent * flight.heights_m[1]
    patch = surface.waves.patch_m
    if side > patch:
        yield Fault(
            "surface.waves.patch_m",
            f"waves repeat after {patch:g} m, in a frame of {side:.0f} m. Enlarge it.",
        )


def swell_does_not_break(surface: Surface) -> Iterator[Fault]:
    """Swell is longer than the shortest resolved wave and less steep than breaking waves."""
    if not surface.swell:
        return
    from terrain.waves.dispersion import wavenumber

    for number, swell in enumerate(surface.swell):
        k = wavenumber(swell.period_s, depth=wave_depth(surface))
        length = 2.0 * pi / k
        highest = STEEPEST * length * tanh(min(k * wave_depth(surface), 100.0))
        if length < resolution(surface).shortest_m:
            yield Fault(
                f"surface.swell.{number}.period_s",
                f"{swell.period_s:g} s make waves of {length:.1f} m, shorter than the shortest "
                f"resolved, {resolution(surface).shortest_m:g} m. Take a longer period.",
            )
        elif swell.height_m > highest:
            yield Fault(
                f"surface.swell.{number}.height_m",
                f"{swell.height_m:g} breaks: waves of {swell.period_s:g} s, {length:.0f} m long, "
                f"stand up to {highest:.2g} m. Lower it.",
            )


SURFACE_RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    wind_makes_the_waves,
    waves_fit_into_the_patch,
    frame_fits_into_the_patch,
    swell_does_not_break,
)
