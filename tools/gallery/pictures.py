"""Which picture shows the point of each scenario, drawn from its run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from survey import open_run
from survey.adjustment import PICTURE, adjust_run
from survey.labelled.flown_run import FlownRun
from survey.labelled.picked import PickedPixels
from survey.labelled.picture import draw
from survey.products.report.report import FIGURES
from tools.gallery.section import section
from viewer.screenshot import screenshot

WIDTH = 1000  # pixels
LARGEST = 150_000  # bytes


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of picture: how it is drawn, and what it shows."""

    draw: Callable[[Path], bytes]
    caption: str


def view(run: Path) -> bytes:
    """Return the picture of `bathyflash view`."""
    return drawn(lambda file: screenshot(run, file, caption=""))


def waveform(run: Path) -> bytes:
    """Return the picture of `bathyflash waveforms --pixel`, of a pixel in the middle."""
    pixel = PickedPixels(FlownRun.open(run)).waveform(frame=0, row=16, column=32)
    return drawn(lambda file: draw(file, pixel))


def strips(run: Path) -> bytes:
    """Return how lines differ before and after `bathyflash adjust`."""
    output = run.with_name(f"{run.name}-adjusted")
    adjust_run(run, output, mode="boresight")
    return (output / PICTURE).read_bytes()


def figure(name: str) -> Callable[[Path], bytes]:
    """Return a way to take one of the report's figures."""
    return lambda run: (run / FIGURES / f"{name}.png").read_bytes()


def drawn(write: Callable[[Path], None]) -> bytes:
    """Return what is written to a file."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        write(file)
        return file.read_bytes()


VIEW = Kind(
    draw=view,
    caption="The stitched bottom coloured by depth, the sea surface, the lines and one flash.",
)
SECTION = Kind(
    draw=lambda run: section(open_run(run)),
    caption="A strip of 5 m along the middle of the flight, from the side.",
)
KINDS = {
    "boresight": Kind(
        draw=strips, caption="How lines differ in height where they overlap, before and after."
    ),
    "every-effect": Kind(
        draw=figure("errors"),
        caption="Measured less true elevation: each flash errs as a whole, in shallow water waves.",
    ),
    "next-generation": Kind(
        draw=figure("depth"), caption="Depths by cells; cubes and pipe stand out of the bed."
    ),
    "paper-p02": SECTION,
    "paper-p05": SECTION,
    "paper-p07": SECTION,
    "special-order": Kind(
        draw=figure("depth"), caption="Depths by cells; the two cubes are yellow."
    ),
    "too-deep": Kind(
        draw=waveform,
        caption="One pixel: light by origin and counts, and gates of counts below their threshold.",
    ),
    "turbid-layer": SECTION,
    "turned-footprint": Kind(
        draw=figure("holes"), caption="Where the bottom was found, and why not elsewhere."
    ),
}


def kind(name: str) -> Kind:
    """Return the kind of picture of a scenario."""
    return KINDS.get(name, VIEW)


def picture(name: str, run: Path) -> bytes:
    """Return the picture of a scenario as a small PNG."""
    whole = Image.open(BytesIO(kind(name).draw(run))).convert("RGB")
    if whole.width > WIDTH:
        size = (WIDTH, whole.height * WIDTH // whole.width)
        whole = whole.resize(size, Image.Resampling.LANCZOS)
    for colours in (256, 128, 64, 32):
        small = BytesIO()
        palette = whole.quantize(colours, kmeans=3)
        palette.save(small, format="PNG", optimize=True)
        if small.tell() < LARGEST:
            return small.getvalue()
    raise ValueError(f"{name}: the picture is larger than {LARGEST} bytes")
