"""Which picture shows the point of each scenario, drawn from its run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from survey.adjustment import PICTURE, adjust_run
from survey.opened.run import Run
from survey.products.report.report import FIGURES
from tools.gallery.section import section
from viewer.screenshot import screenshot

WIDTH = 1000  # pixels
LARGEST = 150_000  # bytes


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of picture: how it is drawn, and what it shows."""

    draw: Callable[[Run], bytes]
    caption: str


def view(run: Run) -> bytes:
    """Return the picture of `bathyflash view`."""
    with TemporaryDirectory() as folder:
        screenshot(run.folder, Path(folder) / "view.png", caption="")
        return (Path(folder) / "view.png").read_bytes()


def strips(run: Run) -> bytes:
    """Return how lines differ before and after `bathyflash adjust`."""
    output = run.folder.with_name(f"{run.folder.name}-adjusted")
    adjust_run(run.folder, output, mode="boresight")
    return (output / PICTURE).read_bytes()


def figure(name: str) -> Callable[[Run], bytes]:
    """Return a way to take one of the report's figures."""
    return lambda run: (run.folder / FIGURES / f"{name}.png").read_bytes()


VIEW = Kind(
    draw=view,
    caption="The stitched bottom coloured by depth, the sea surface, the lines and one flash.",
)
SECTION = Kind(
    draw=section,
    caption="A strip of 5 m along the middle of the flight, from the side.",
)
KINDS = {
    "boresight": Kind(
        draw=strips, caption="How lines differ in height where they overlap, before and after."
    ),
    "paper-p02": SECTION,
    "paper-p05": SECTION,
    "paper-p07": SECTION,
    "too-deep": Kind(
        draw=figure("waveform"),
        caption="The light of one pixel by origin, what was counted, and the threshold.",
    ),
    "turbid-layer": SECTION,
    "turned-footprint": Kind(
        draw=figure("holes"), caption="Where the bottom was found, and why not elsewhere."
    ),
}


def kind(name: str) -> Kind:
    """Return the kind of picture of a scenario."""
    return KINDS.get(name, VIEW)


def picture(name: str, run: Run) -> bytes:
    """Return the picture of a scenario as a small PNG."""
    drawn = Image.open(BytesIO(kind(name).draw(run))).convert("RGB")
    if drawn.width > WIDTH:
        size = (WIDTH, drawn.height * WIDTH // drawn.width)
        drawn = drawn.resize(size, Image.Resampling.LANCZOS)
    for colours in (256, 128, 64, 32):
        small = BytesIO()
        palette = drawn.quantize(colours, kmeans=3)
        palette.save(small, format="PNG", optimize=True)
        if small.tell() < LARGEST:
            return small.getvalue()
    raise ValueError(f"{name}: the picture is larger than {LARGEST} bytes")
