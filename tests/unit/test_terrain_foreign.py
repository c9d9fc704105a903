"""Foreign files are read in a child: whatever becomes of it, the parent says so in a line."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pytest
import rasterio
from pyproj import CRS

from terrain.file_faults import SeabedFileError
from terrain.foreign.faults import ForeignFileError
from terrain.foreign.limits import GIB, Limits
from terrain.foreign.reading import read_foreign
from terrain.importers import from_las, from_raster

UTM: dict[str, Any] = {"epsg": 25832, "vertical_epsg": 5714, "reflectance": 0.1}
FILE = Path("wreck.ply")


@dataclass(frozen=True, kw_only=True)
class Impatient(Limits):
    """Limits with a short wait."""

    @property
    def waiting_time(self) -> int:
        return 2


def ask(reader: str, limits: Limits | None = None, **arguments: Any) -> dict[str, Any]:
    limits = limits or Limits(memory=GIB, processor_time=20)
    name = f"tests.unit.foreign_readers:{reader}"
    return read_foreign(name, FILE, limits=limits, **arguments)


def test_arrays_and_words_come_back() -> None:
    found = ask("double", numbers=[1.0, 2.5])
    np.testing.assert_array_equal(found["twice"], [2.0, 5.0])
    assert str(found["name"]) == "wreck.ply"


@pytest.mark.parametrize(
    ("reader", "line"),
    [
        ("find_faults", "wreck.ply: face 3: no area\nwreck.ply: vertex 5: not finite"),
        (
            "stumble",
            "wreck.ply: not a readable mesh file: fetch or export it again. 'offset\\n of chunk'",
        ),
        ("forget", "wreck.ply: the reader failed. RuntimeError: what is this?"),
        ("abort", "wreck.ply: the reader crashed (SIGABRT). the file is damaged"),
        ("overrun", "wreck.ply: the reader crashed (SIGSEGV). the file is damaged"),
        (
            "swallow",
            "wreck.ply: asks for more memory than the 1.0 GiB allowed. it may be damaged; "
            "otherwise cut or coarsen it",
        ),
    ],
)
def test_every_end_of_the_child_is_a_line_about_the_file(reader: str, line: str) -> None:
    with pytest.raises(ForeignFileError) as refused:
        ask(reader)
    assert str(refused.value) == line


def test_a_reader_that_never_ends_is_ended_by_its_processor_time() -> None:
    with pytest.raises(ForeignFileError, match="within 1 s of processor time"):
        ask("spin", Limits(memory=GIB, processor_time=1))


def test_a_reader_that_waits_is_ended_by_the_clock() -> None:
    with pytest.raises(ForeignFileError, match="could not be read within 2 s"):
        ask("wait", Impatient(memory=GIB, processor_time=20))


def test_many_threads_may_ask_at_once() -> None:
    with ThreadPoolExecutor(6) as pool:
        found = list(pool.map(lambda n: ask("double", numbers=[float(n)])["twice"][0], range(6)))
    assert found == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]


@pytest.mark.parametrize("reader", ["raster_reader", "las_reader", "mesh_reader"])
def test_the_child_imports_no_more_than_it_needs(reader: str) -> None:
    """Start-up is the price of every file: no compiled kernels, no plotting, no scenario."""
    program = (
        f"import sys, terrain.foreign.child, terrain.foreign.{reader}\n"
        "print(*sorted({m.partition('.')[0] for m in sys.modules}))"
    )
    words = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    loaded = set(words.stdout.split())
    assert "terrain" in loaded
    assert not loaded & {"numba", "scipy", "pydantic", "survey", "trimesh", "rasterio", "laspy"}


def sparse_raster(path: Path, side: int, **profile: Any) -> Path:
    """Write a raster of side x side cells of 1 m; if tiled, 64 x 64 about the middle have data."""
    from affine import Affine
    from rasterio.windows import Window

    middle = side // 2
    with rasterio.open(
        path,
        "w",
        driver="GTiff",
        width=side,
        height=side,
        count=1,
        dtype="float32",
        crs="EPSG:25832",
        transform=Affine(1.0, 0.0, 500000.0 - middle, 0.0, -1.0, 6000000.0 + middle),
        nodata=-9999.0,
        sparse_ok=True,
        **profile,
    ) as raster:
        if profile.get("tiled"):
            _, cols = np.mgrid[:64, :64].astype(np.float32)
            raster.write(-8.0 - 0.01 * cols, 1, window=Window(middle - 32, middle - 32, 64, 64))
    return path


def test_a_raster_larger_than_memory_is_read_where_it_is_flown(tmp_path: Path) -> None:
    """200,000 x 200,000 cells would take 149 GiB; the file holds 64 x 64 of them."""
    path = sparse_raster(
        tmp_path / "ocean.tif", 200_000, tiled=True, blockxsize=256, blockysize=256, bigtiff="YES"
    )
    assert path.stat().st_size < 20e6
    outline = np.array([[499990.0, 5999990.0], [500010.0, 5999990.0], [500000.0, 6000012.0]])
    seabed = from_raster(path, outline=outline, margin=5.0, **UTM)
    assert len(seabed.mesh.vertices) < 40 * 40
    assert float(seabed.elevation_at(0.0, 0.0)) == pytest.approx(-8.0 - 0.01 * 31.5, abs=1e-5)
    with pytest.raises(SeabedFileError, match=r"size: 200000 x 200000 cells.*cut the raster"):
        from_raster(path, **UTM)


def test_a_raster_that_cannot_be_read_in_parts_is_refused(tmp_path: Path) -> None:
    """One strip of 1.6 GB must be unpacked for a single cell of it."""
    path = sparse_raster(
        tmp_path / "strip.tif", 20_000, blockysize=20_000, compress="deflate", bigtiff="YES"
    )
    outline = np.array([[499990.0, 5999990.0], [500010.0, 5999990.0], [500000.0, 6000012.0]])
    with pytest.raises(SeabedFileError) as refused:
        from_raster(path, outline=outline, **UTM)
    assert str(refused.value).startswith(f"{path}: ")
    assert "memory" in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


def test_mutated_point_files_end_in_a_line_each(tmp_path: Path) -> None:
    """Four changed bytes may keep a reader busy for a minute or abort it from compiled code."""
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = np.full(3, 0.001), np.array([500000.0, 6000000.0, 0.0])
    header.add_crs(CRS.from_epsg(25832))
    data = laspy.LasData(header)
    rng = np.random.default_rng(1)
    data.x, data.y = 500000.0 + rng.uniform(0, 30, 3000), 6000000.0 + rng.uniform(0, 30, 3000)
    data.z, data.classification = rng.normal(-8.0, 0.1, 3000), np.full(3000, 40)
    data.write(tmp_path / "sound.laz")
    whole = (tmp_path / "sound.laz").read_bytes()
    endings = []
    for number in range(8):
        content = bytearray(whole)
        for place in rng.integers(0, len(whole) if number % 2 else 375, 4):
            content[place] ^= int(rng.integers(1, 256))
        path = tmp_path / f"mutant-{number}.laz"
        path.write_bytes(content)
        endings.append(ending_of(path))
    assert all(ending == "" or ending.startswith(f"{tmp_path}/mutant-") for ending in endings)
    assert any(endings)


def ending_of(path: Path) -> str:
    """Return what is said of a point file, nothing where it can be read."""
    try:
        from_las(path, classes=[40], cell=1.0, **UTM)
    except SeabedFileError as fault:
        return str(fault)
    return ""
