"""The variables of labelled waveforms: dimensions, types, units and words, after CF 1.11.

``standard_name`` stands where the CF table has the quantity. Photo-electrons and counts are pure
numbers there, of unit 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from survey.cloud.points import Outcome, PointClass

FRAME = ("frame",)
PIXEL = ("frame", "row", "column")
BIN = (*PIXEL, "bin")
TAG = ("tag",)
LAYER = ("layer",)


@dataclass(frozen=True, kw_only=True)
class Variable:
    """One variable.

    Parameters
    ----------
    dims : tuple of str
    dtype : str
        As stored.
    words : str
        CF's ``long_name``.
    units : str or None
        As UDUNITS has them; None for codes and for what xarray encodes.
    more : mapping
        Further attributes.
    """

    dims: tuple[str, ...]
    dtype: str
    words: str
    units: str | None = "1"
    more: Mapping[str, Any] = field(default_factory=dict)

    @property
    def attributes(self) -> dict[str, Any]:
        """All attributes."""
        units = {} if self.units is None else {"units": self.units}
        return {"long_name": self.words, **units, **self.more}


def _light(words: str, **more: str) -> Variable:
    return Variable(
        dims=BIN,
        dtype="f4",
        words=f"expected photo-electrons of {words} in one bin of one pulse",
        more={"cell_methods": "bin: sum", **more},
    )


def _light_error(words: str) -> Variable:
    return Variable(
        dims=BIN, dtype="f4", words=f"Monte Carlo standard error of the photo-electrons of {words}"
    )


def _threshold(words: str) -> Variable:
    return Variable(
        dims=BIN,
        dtype="f4",
        words=f"counts that the gate centred on the bin must hold for {words}",
        more={"comment": "a gate is `gate_bins` bins of `counts` summed"},
    )


def _two_way_time(words: str) -> Variable:
    return Variable(dims=PIXEL, dtype="f8", words=f"two-way time after emission {words}", units="s")


def _uncertainty(words: str) -> Variable:
    return Variable(
        dims=PIXEL, dtype="f4", words=f"total {words} uncertainty of the point, 95 %", units="m"
    )


def _codes(words: str, codes: Mapping[int, str]) -> Variable:
    return Variable(dims=PIXEL, dtype="u1", words=words, units=None, more=flags(codes))


def flags(codes: Mapping[int, str]) -> dict[str, Any]:
    """Return CF's attributes of codes.

    Examples
    --------
    >>> flags({0: "unlabelled", 1: "coarse sand"})["flag_meanings"]
    'unlabelled coarse_sand'
    """
    import numpy as np

    return {
        "flag_values": np.array(list(codes), np.uint8),
        "flag_meanings": " ".join("_".join(name.lower().split()) for name in codes.values()),
    }


def _place(words: str, dims: tuple[str, ...] = PIXEL) -> dict[str, Variable]:
    axes = {
        "easting": {"standard_name": "projection_x_coordinate"},
        "northing": {"standard_name": "projection_y_coordinate"},
        "up": {"positive": "up"},
    }
    return {
        axis: Variable(
            dims=dims,
            dtype="f8",
            words=f"{axis} of {words}",
            units="m",
            more={**more, "grid_mapping": "crs"},
        )
        for axis, more in axes.items()
    }


def _pose(prefix: str, words: str) -> dict[str, Variable]:
    turns = {
        "roll": {"standard_name": "platform_roll_starboard_down"},
        "pitch": {"standard_name": "platform_pitch_fore_up"},
        "heading": {"comment": "clockwise from grid north"},
    }
    place = _place(f"the sensor, {words}", FRAME)
    found = {f"{prefix}_{axis}": variable for axis, variable in place.items()}
    for turn, more in turns.items():
        said = f"{turn} of the sensor, {words}"
        found[f"{prefix}_{turn}"] = Variable(
            dims=FRAME, dtype="f8", words=said, units="radian", more=more
        )
    return found


CLASSES = {int(kind): kind.name for kind in PointClass}
OUTCOMES = {int(outcome): outcome.name for outcome in Outcome}

INDICES = {
    "frame": Variable(dims=FRAME, dtype="i4", words="number of the flash in the mission"),
    "row": Variable(dims=("row",), dtype="i4", words="row of the pixel in the camera"),
    "column": Variable(dims=("column",), dtype="i4", words="column of the pixel in the camera"),
}

COORDINATES = {
    "bin_time": Variable(
        dims=("bin",), dtype="f8", words="centre of the bin after emission", units="s"
    ),
    "frame_time": Variable(
        dims=FRAME,
        dtype="f8",
        words="time of the flash, UTC",
        units=None,
        more={"standard_name": "time"},
    ),
    **_place("where the unscattered ray of the pixel truly meets seabed or land"),
}

LIGHT = {
    "expected_surface": _light(
        "the water surface", comment="computed without chance: no Monte Carlo error"
    ),
    "expected_column": _light(
        "the water column", ancillary_variables="expected_column_standard_error"
    ),
    "expected_bottom": _light(
        "bottom and land", ancillary_variables="expected_bottom_standard_error"
    ),
    "expected_background": Variable(
        dims=FRAME,
        dtype="f4",
        words="expected photo-electrons of sun, sky and darkness in one bin of one pulse",
        more={"comment": "the same in every pixel and bin"},
    ),
    "expected_column_standard_error": _light_error("the water column"),
    "expected_bottom_standard_error": _light_error("bottom and land"),
}

READINGS = {
    "counts": Variable(
        dims=BIN,
        dtype="u2",
        words="simulated readings, all pulses of the frame summed",
        more={"cell_methods": "bin: sum"},
    ),
    "surface_threshold": _threshold("a first echo"),
    "bottom_threshold": _threshold("a bottom echo"),
}

LABELS = {
    "detected_surface_time": _two_way_time("of the first echo, as ranged"),
    "detected_bottom_time": _two_way_time("of the bottom echo, as ranged"),
    "classification": _codes("class of the point that was made, LAS 1.4", CLASSES),
    "outcome": _codes("what became of the bottom", OUTCOMES),
    "detection_probability": Variable(
        dims=PIXEL, dtype="f4", words="probability that the true bottom echo fires its threshold"
    ),
    "tvu": _uncertainty("vertical"),
    "thu": _uncertainty("horizontal"),
    "true_surface_time": _two_way_time("to the water, or to land"),
    "true_bottom_time": _two_way_time("to seabed or land along the unscattered ray"),
    "true_depth": Variable(
        dims=PIXEL,
        dtype="f4",
        words="depth of that place under the water level without waves, negative on land",
        units="m",
        more={"standard_name": "depth", "positive": "down"},
    ),
    "water_path": Variable(
        dims=PIXEL, dtype="f4", words="one way of the unscattered ray in water", units="m"
    ),
    **{
        f"surface_normal_{axis}": Variable(
            dims=PIXEL, dtype="f4", words=f"component {axis} of the unit normal of the water there"
        )
        for axis in ("east", "north", "up")
    },
    **{
        f"surface_{axis}": variable
        for axis, variable in _place("where that ray truly meets the water, or land").items()
    },
    "true_classification": _codes("class of what is truly there, LAS 1.4", CLASSES),
    "substrate": _codes("what seabed or land is made of there", {}),
}

POSES = _pose("sensor", "true") | _pose("navigation", "as navigation says")

TAG_COUNT = Variable(
    dims=PIXEL,
    dtype="i4",
    words="number of time tags of the pixel",
    more={
        "sample_dimension": "tag",
        "comment": "tags lie by frame, row and column: the first of a pixel stands where the "
        "counts of all pixels before it add up",
    },
)
TAGS = {
    "tag_time": Variable(
        dims=TAG, dtype="f4", words="time of the count after the gate opens", units="s"
    ),
    "tag_pulse": Variable(dims=TAG, dtype="i4", words="pulse of the frame's burst, from 0"),
}

WATER = {
    "layer_top": Variable(
        dims=LAYER,
        dtype="f8",
        words="upper edge of the layer of water under mean level",
        units="m",
        more={"standard_name": "depth", "positive": "down"},
    ),
    "absorption": Variable(
        dims=LAYER,
        dtype="f8",
        words="absorption coefficient of the water",
        units="m-1",
        more={"standard_name": "volume_absorption_coefficient_of_radiative_flux_in_sea_water"},
    ),
    "scattering": Variable(
        dims=LAYER,
        dtype="f8",
        words="scattering coefficient of the water",
        units="m-1",
        more={"standard_name": "volume_scattering_coefficient_of_radiative_flux_in_sea_water"},
    ),
}

VARIABLES = (
    INDICES | COORDINATES | LIGHT | READINGS | LABELS | POSES | {"tag_count": TAG_COUNT}
    | TAGS | WATER
)  # fmt: skip
