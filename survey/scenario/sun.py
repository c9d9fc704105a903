"""The sun's section: values that follow from its words, and the rules that bind them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from survey.scenario.faults import Fault
from survey.scenario.sections import Flight, Laser, Receiver, Sun
from survey.scenario.surface_sections import Surface
from survey.scenario.water_sections import PetzoldWater, WaterSection, topmost

PAPER_IRRADIANCE_W_M2_NM = 1.95  # E_perp at 0.53 um, [Lisenko2017]
PAPER_WATER_REFLECTANCE = 0.0097  # rho_s, the lower end of [Lisenko2017]
# The paper says 0.0097 to 0.0121 by type of water. Assumed: its ends and its middle, in the order
# of backscatter over absorption of Petzold's waters.
REFLECTANCE_OF_WATER = {"clear": 0.0097, "coastal": 0.0109, "harbor": 0.0121}
HIGH_FLIGHT_M = 10_000.0  # from here on equation (7) holds, [Lisenko2017]
PAPER_ZENITH_DEG, PAPER_WINDS_M_S = 20.0, (2.0, 5.0)  # where [Lisenko2017] prints rho_sf
COX_MUNK_WINDS_M_S = (1.0, 14.0)  # measured range, Cox and Munk (1954)
ROUNDING = 1e-9
LEAST_LEGENDRE_MOMENT = -2.0  # below it (5) can give less light than the sun's beam alone


def water_reflectance(sun: Sun, water: WaterSection) -> float:
    """Return rho_s: by the type of the topmost water, as stated, or the paper's lower end [1]."""
    if sun.water_light == "by_water_type":
        top = topmost(water)
        assert isinstance(top, PetzoldWater)
        return REFLECTANCE_OF_WATER[top.type]
    return PAPER_WATER_REFLECTANCE if sun.water_reflectance is None else sun.water_reflectance


def stated_irradiance_w_m2_nm(sun: Sun) -> float:
    """Return E_perp as stated, or the paper's [W/(m2 nm)]."""
    given = sun.solar_irradiance_w_m2_nm
    return PAPER_IRRADIANCE_W_M2_NM if given is None else given


def air_extinction_per_m(sun: Sun, flight: Flight) -> float:
    """Return eps of tau = eps H: as stated, or air that is uniform up to 10 km [1/m].

    Assumed, for equation (7), where all air lies below the receiver, holds from there on.

    Examples
    --------
    >>> round(air_extinction_per_m(Sun(), Flight(kind="lines")), 12)
    3e-05
    """
    if sun.air_extinction_per_m is not None:
        return sun.air_extinction_per_m
    return sun.optical_thickness / max(HIGH_FLIGHT_M, flight.height_m)


def sun_is_stated_once(sun: Sun) -> Iterator[Fault]:
    """No number stands beside a word that sets it or has no use for it."""
    if sun.spectrum == "astm_g173" and sun.solar_irradiance_w_m2_nm is not None:
        yield Fault(
            "sun.solar_irradiance_w_m2_nm",
            'sun.spectrum = "astm_g173" already says it. Leave one of them out.',
        )
    if sun.water_light == "by_water_type" and sun.water_reflectance is not None:
        yield Fault(
            "sun.water_reflectance",
            'sun.water_light = "by_water_type" already says it. Leave one of them out.',
        )
    if sun.model != "layered" and sun.air_extinction_per_m is not None:
        yield Fault(
            "sun.air_extinction_per_m",
            f'sun.model = "{sun.model}" has no use for it. Take "layered" or leave it out.',
        )


def glint_is_within_its_measurements(sun: Sun, surface: Surface) -> Iterator[Fault]:
    """Cox and Munk's slopes are used in their winds, under a sky that gives light."""
    if sun.glint != "cox_munk" or not _shines(sun):
        return
    wind, (least, most) = surface.wind_speed_m_s, COX_MUNK_WINDS_M_S
    if not least <= wind <= most:
        yield Fault(
            "surface.wind_speed_m_s",
            f'{wind:g} is outside {least:g} to {most:g} m/s, in which sun.glint = "cox_munk" was '
            'measured. Change it or take sun.glint = "paper".',
        )
    if sun.legendre_moment < LEAST_LEGENDRE_MOMENT:
        yield Fault(
            "sun.legendre_moment",
            f"{sun.legendre_moment:g} can leave the sky a negative irradiance in equation (5), "
            f'and sun.glint = "cox_munk" mirrors it. Take {LEAST_LEGENDRE_MOMENT:g} or more.',
        )


def high_flight_is_high(sun: Sun, flight: Flight) -> Iterator[Fault]:
    """Equation (7) is for receivers above the air."""
    if sun.model == "high_flight" and _shines(sun) and flight.height_m < HIGH_FLIGHT_M:
        yield Fault(
            "sun.model",
            f'"high_flight" holds from {HIGH_FLIGHT_M:g} m up, flight.height_m is '
            f'{flight.height_m:g}. Take "low_flight" or "layered".',
        )


def air_below_is_part_of_the_air(sun: Sun, flight: Flight) -> Iterator[Fault]:
    """The air below the receiver is no thicker than all of the air."""
    if sun.model != "layered" or not _shines(sun):
        return
    layer = air_extinction_per_m(sun, flight) * flight.height_m
    if layer > sun.optical_thickness * (1.0 + ROUNDING):
        yield Fault(
            "sun.air_extinction_per_m",
            f"over {flight.height_m:g} m it makes an optical thickness of {layer:g}, more than "
            f"sun.optical_thickness {sun.optical_thickness:g} of all the air. Lower it.",
        )


def filter_is_within_the_spectrum(sun: Sun, laser: Laser, receiver: Receiver) -> Iterator[Fault]:
    """The filter's band lies in the tabled spectrum."""
    from survey.optics.solar_spectrum import TABLED_NM

    if sun.spectrum != "astm_g173" or not _shines(sun):
        return
    half, (first, last) = 0.5 * receiver.filter_width_nm, TABLED_NM
    if laser.wavelength_nm - half < first or laser.wavelength_nm + half > last:
        yield Fault(
            "receiver.filter_width_nm",
            f"{receiver.filter_width_nm:g} nm around {laser.wavelength_nm:g} nm leaves the tabled "
            f'spectrum, {first:g} to {last:g} nm. Narrow it or take sun.spectrum = "stated".',
        )


def sun_notes(sun: Sun, surface: Surface) -> Iterator[str]:
    """Yield a line when the paper's surface brightness is used where it is not printed."""
    least, most = PAPER_WINDS_M_S
    printed = sun.zenith_deg == PAPER_ZENITH_DEG and least <= surface.wind_speed_m_s <= most
    if sun.glint == "paper" and _shines(sun) and not printed:
        yield (
            f'sun.glint = "paper" is known for a sun at {PAPER_ZENITH_DEG:g} degrees and winds of '
            f"{least:g} to {most:g} m/s, here {sun.zenith_deg:g} degrees and "
            f'{surface.wind_speed_m_s:g} m/s; "cox_munk" knows others'
        )


def _shines(sun: Sun) -> bool:
    return sun.day and sun.radiance_w_m2_um_sr is None


SUN_RULES: tuple[Callable[..., Iterator[Fault]], ...] = (
    sun_is_stated_once,
    glint_is_within_its_measurements,
    high_flight_is_high,
    air_below_is_part_of_the_air,
    filter_is_within_the_spectrum,
)
