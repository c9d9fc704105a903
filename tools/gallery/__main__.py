"""Fly every scenario of the gallery, draw each, and write docs/gallery.md: `make gallery`.

Flights go on where they stopped; what is flown already, by the same code, is not flown again.
`python -m tools.gallery NAME ...` takes these alone; --draw-only takes the runs as they stand.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

from survey.products.writing import write_whole
from survey.run_identity import MANIFEST
from survey.scenario.gallery import gallery
from tools.gallery.flights import fly_anew, metrics_of
from tools.gallery.page import page
from tools.gallery.pictures import picture

ROOT = Path(__file__).parents[2]
RUNS, DOCS = ROOT / "runs/gallery", ROOT / "docs"


def main() -> None:
    """Fly, draw and write."""
    asked = arguments()
    for name in asked.names:
        print(f"{name}:", flush=True)
        if not asked.draw_only:
            fly_anew(name, RUNS / name)
        write_whole(DOCS / f"gallery/{name}.png", picture(name, RUNS / name))
    found = {name: metrics_of(RUNS / name) for name in gallery() if is_drawn(name)}
    write_whole(DOCS / "gallery.md", page(found).encode())
    print(f"written: {DOCS / 'gallery.md'}")


def is_drawn(name: str) -> bool:
    """Tell whether a scenario has a run and a picture; the page says which have not."""
    return (RUNS / name / MANIFEST).exists() and (DOCS / f"gallery/{name}.png").exists()


def arguments() -> Namespace:
    """Return what was asked for."""
    parser = ArgumentParser(prog="python -m tools.gallery", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--draw-only", action="store_true", help="fly nothing")
    asked = parser.parse_args()
    asked.names = asked.names or list(gallery())
    return asked


if __name__ == "__main__":
    main()
