"""Labelled waveforms: what is in them, that they are the run's own, and that they are whole."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from scipy.constants import speed_of_light
from typer.testing import CliRunner, Result

from survey import open_run
from survey.cli import app
from survey.cloud.points import Outcome
from survey.errors import OtherRunError, UserError
from survey.labelled import store
from survey.labelled.dataset import labelled_waveforms, tags_of
from survey.labelled.export import write_waveforms
from survey.labelled.flown_run import FlownRun
from survey.labelled.picked import PickedPixels
from survey.labelled.pixels import Pixels
from survey.labelled.store import Layout, open_waveforms
from survey.mission import fly
from survey.preparation import prepare
from survey.products.frame_file import read_frame, read_raw
from survey.scenario.scenario import Scenario

PAGE = Path(__file__).parents[2] / "docs/waveforms.md"
CAMERA = (4, 8)
TAGS = ["tag_time", "tag_pulse"]
ALL = Pixels.every(1, CAMERA)
TABLES: dict[str, Any] = {
    "mission": {"title": "a test", "start_utc": "2026-06-21T12:00:00+02:00"},
    "flight": {
        "start_easting_m": 500250.0,
        "start_northing_m": 6000750.0,
        "heading_deg": 90.0,
        "frames_per_line": 3,
        "speed_m_s": 20.0,
    },
    "camera": {"rows": 4, "columns": 8},
    "laser": {"pulse_energy_j": 5e-5},
    "sun": {"day": False},
    "receiver": {"aperture_radius_m": 0.005, "filter_width_nm": 1.0},
    "detector": {
        "kind": "spad",
        "quantum_efficiency": 0.2,
        "dark_count_rate_hz": 1e4,
        "dead_time_ns": 20.0,
        "pulses_per_frame": 100,
    },
    "water": {"type": "coastal"},
    "surface": {"water_level_m": 0.5},
    "transport": {"walks_per_pixel": 16, "tracks_per_replicate": 128},
    "seabed": {"kind": "slope", "depth_m": 4.0, "slope_deg": 3.0, "downhill_deg": 90.0,
               "substrate": "sand"},
    "processing": {"keep_waveforms": "all"},
}  # fmt: skip
STANDARD_NAMES = {
    *("time", "depth", "projection_x_coordinate", "projection_y_coordinate"),
    *("platform_roll_starboard_down", "platform_pitch_fore_up"),
    "volume_absorption_coefficient_of_radiative_flux_in_sea_water",
    "volume_scattering_coefficient_of_radiative_flux_in_sea_water",
}
"""Those in use, each looked up in the CF standard name table, version 92."""


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Scenario:
    from survey.scenario.load import load_scenario
    from survey.scenario.toml_text import to_toml

    file = tmp_path_factory.mktemp("scenario") / "reef.toml"
    file.write_text(
        to_toml(TABLES).replace('"2026-06-21T12:00:00+02:00"', "2026-06-21T12:00:00+02:00")
    )
    return load_scenario(file)


@pytest.fixture(scope="module")
def run(scenario: Scenario, tmp_path_factory: pytest.TempPathFactory) -> FlownRun:
    folder = str(tmp_path_factory.mktemp("run") / "run")
    return FlownRun.open(fly(scenario, folder, workers=1))


@pytest.fixture(scope="module")
def written(run: FlownRun, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_waveforms(run, tmp_path_factory.mktemp("zarr") / "all.zarr", pixels=ALL)


@pytest.fixture
def found(written: Path) -> xarray.Dataset:
    return xarray.open_zarr(written)


def contents(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def test_counts_and_tags_are_those_that_the_run_kept(run: FlownRun, found: xarray.Dataset) -> None:
    assert dict(found.counts.sizes) == {"frame": 3, "row": 4, "column": 8, "bin": 300}
    for frame in range(3):
        raw = read_raw(run.folder / f"frames/{frame:06d}.npz")
        assert raw is not None
        assert np.array_equal(found.counts[frame].values[raw.row, raw.column], raw.counts)
        order = np.lexsort((raw.tag_time, raw.tag_pulse, raw.tag_column, raw.tag_row))
        start = int(found.tag_count[:frame].sum())
        own = slice(start, start + len(order))
        assert np.array_equal(found.tag_time[own], raw.tag_time[order])
        assert np.array_equal(found.tag_pulse[own], raw.tag_pulse[order])
    assert found.counts.dtype == np.uint16
    assert int(found.tag_count.sum()) == found.sizes["tag"] == int(found.counts.sum())


def test_an_opened_run_gives_the_same_waveforms(run: FlownRun, found: xarray.Dataset) -> None:
    opened = open_run(run.folder)
    assert len(opened.surface) == opened.metrics["points_surface"] > 0
    waves = opened.waveforms([0, 2])
    assert waves.equals(found.isel(frame=[0, 2]).drop_dims("tag").load().merge(waves[TAGS]))
    assert opened.waveforms(2).counts.equals(found.counts.sel(frame=2))


def test_time_tags_fall_into_the_bins_of_their_pixel(found: xarray.Dataset) -> None:
    for frame, row, column in ((0, 0, 0), (1, 2, 5), (2, 3, 7)):
        own = tags_of(found, frame=frame, row=row, column=column)
        edges = np.arange(301) * found.bin_width_s
        again, _ = np.histogram(found.tag_time[own], np.where(edges == edges[-1], np.inf, edges))
        counts = found.counts[frame, row, column].values.astype(int)
        assert again.sum() == counts.sum() > 0
        assert np.abs(again - counts).sum() <= 2  # a time on an edge, in 32 bits


def test_truth_hangs_together(run: FlownRun, found: xarray.Dataset) -> None:
    path = np.sqrt(
        sum((found[a] - found[f"surface_{a}"]) ** 2 for a in ("easting", "northing", "up"))
    )
    assert np.allclose(path, found.water_path, atol=1e-6)
    in_water = 2.0 * found.group_index * path / speed_of_light
    assert np.allclose(found.true_bottom_time, found.true_surface_time + in_water, atol=1e-13)
    assert np.allclose(found.water_level_m - found.up, found.true_depth, atol=1e-5)
    for frame in range(3):
        kept = read_frame(run.folder / f"frames/{frame:06d}.npz")
        assert np.array_equal(found.outcome[frame], kept.record.outcome)
        assert np.array_equal(
            found.classification[frame].values.ravel(), kept.bottom.classification
        )
        east = kept.record.true_position[..., 0] + 500e3
        assert np.array_equal(found.easting[frame], east)
    assert np.array_equal(found.frame_time.values.astype("datetime64[s]"),
                          np.datetime64("2026-06-21T10:00:00") + np.arange(3))  # fmt: skip
    assert float((found.outcome == Outcome.FOUND).mean()) > 0.8
    late = found.detected_bottom_time - found.true_bottom_time
    assert abs(float(np.nanmedian(late))) < 8e-9  # dead time tells strong echoes early
    assert np.nanmax(np.abs(found.detected_surface_time - found.true_surface_time)) < 8e-9


def test_light_of_every_origin_makes_the_counts_where_it_prevails() -> None:
    """An ideal counter's sums are Poisson's about the expected ones: within 4.5 deviations."""
    ideal = {"quantum_efficiency": 0.2, "dark_count_rate_hz": 1e4}
    tables = TABLES | {"detector": ideal, "laser": {"pulse_energy_j": 0.1}, "sun": {}}
    mission = prepare(Scenario.from_tables(tables_with_time(tables), name="x", folder=Path()))
    found = labelled_waveforms(mission, mission.frames[0])
    origins = ("surface", "column", "bottom", "background")
    total = sum(found[f"expected_{origin}"] for origin in origins)
    for origin, largest_error in zip(origins, (0.01, 0.03, 0.01, 0.2), strict=True):
        prevails = found[f"expected_{origin}"] > 0.6 * total
        expected = float(total.where(prevails).sum())
        counted = float(found.counts.where(prevails).sum())
        assert abs(counted - expected) < 4.5 * expected**0.5 < largest_error * expected
    for origin in ("column", "bottom"):
        lit = found[f"expected_{origin}"].sum("bin")
        error = np.sqrt((found[f"expected_{origin}_standard_error"] ** 2).sum("bin"))
        assert 0.0 < float((error / lit).median()) < 0.3


def tables_with_time(tables: dict[str, Any]) -> dict[str, Any]:
    from datetime import datetime

    start = datetime.fromisoformat(tables["mission"]["start_utc"])
    return tables | {"mission": tables["mission"] | {"start_utc": start}}


def test_same_bytes_for_any_workers(run: FlownRun, written: Path, tmp_path: Path) -> None:
    again = write_waveforms(run, tmp_path / "again.zarr", pixels=ALL, workers=3)
    assert contents(again) == contents(written)


def test_a_sample_in_small_chunks_is_that_part_of_all(
    run: FlownRun, found: xarray.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "CHUNK_BYTES", 2 * 300 * 4)
    monkeypatch.setattr(store, "BLOCK_BYTES", 0)
    pixels = Pixels(rows=range(1, 4, 2), columns=range(2, 8, 3))
    path = write_waveforms(run, tmp_path / "a.zarr", pixels=pixels, frames=range(1, 3))
    part = open_waveforms(path)
    assert part.counts.encoding["chunks"] == (1, 1, 2, 300)
    whole = found.sel(frame=[1, 2], row=[1, 3], column=[2, 5])
    assert part.drop_dims("tag").equals(whole.drop_dims("tag"))
    own = part.tag_time[tags_of(part, frame=1, row=1, column=0)]
    assert np.array_equal(own, found.tag_time[tags_of(found, frame=2, row=3, column=2)])


def test_layouts_keep_blocks_of_whole_chunks() -> None:
    for rows, columns, bins in ((32, 64, 300), (4, 8, 300), (256, 512, 1000), (1, 1, 1)):
        layout = Layout.of(frames=5000, rows=rows, columns=columns, bins=bins)
        assert layout.block % layout.chunk == 0
        assert layout.chunk * layout.rows * columns * bins * 4 <= max(
            store.CHUNK_BYTES, columns * bins * 4
        )
        assert 1 <= layout.rows <= rows


def test_one_frame_in_memory_is_the_frame_on_the_disk(
    scenario: Scenario, run: FlownRun, found: xarray.Dataset
) -> None:
    mission = prepare(scenario)
    one = labelled_waveforms(mission, mission.frames[1])
    part = found.isel(frame=[1]).drop_dims("tag")
    for name, variable in part.variables.items():
        assert np.array_equal(one[name], variable, equal_nan=variable.dtype.kind == "f"), name
    pixel = PickedPixels(run).waveform(frame=1, row=2, column=5)
    assert pixel.counts.dims == ("bin",)
    assert np.array_equal(pixel.counts, found.counts[1, 2, 5])
    assert pixel.sizes["tag"] == int(found.tag_count[1, 2, 5])
    assert np.array_equal(pixel.tag_time, found.tag_time[tags_of(found, frame=1, row=2, column=5)])


def test_every_variable_is_described_as_cf_asks(written: Path) -> None:
    raw = xarray.open_zarr(written, decode_cf=False)
    assert raw.Conventions == "CF-1.11"
    assert "simulated" in raw.comment
    assert {"scenario", "scenario_sha256", "seed", "title", "source", "pulse_fwhm_s"} <= set(
        raw.attrs
    )
    for name, variable in raw.variables.items():
        attributes = variable.attrs
        assert str(name).isidentifier()
        assert attributes["long_name"], name
        codes = attributes.get("flag_values")
        if codes is not None:
            meanings = attributes["flag_meanings"].split()
            assert len(codes) == len(set(codes)) == len(set(meanings)) == len(meanings)
            assert set(np.unique(variable)) <= set(codes), name
        elif name != "crs":
            assert attributes["units"] in ("1", "s", "m", "m-1", "radian") or (
                name == "frame_time" and attributes["units"] == "seconds since 2026-06-21"
            )
        assert attributes.get("standard_name", "time") in STANDARD_NAMES
        others = " ".join(
            str(attributes.get(key, ""))
            for key in ("coordinates", "ancillary_variables", "grid_mapping")
        )
        for other in others.split():
            assert other in raw.variables, name
    assert raw.variables["crs"].attrs["crs_wkt"].startswith("COMPOUNDCRS")
    assert raw.tag_count.attrs["sample_dimension"] == "tag"
    assert raw.substrate.attrs["flag_meanings"] == "unlabelled sand"


def test_a_chunk_that_is_missing_is_missed(written: Path, tmp_path: Path) -> None:
    for name in ("counts/0.0.0.0", "tag_time/0", "crs/0"):
        torn = tmp_path / name.replace("/", "-")
        shutil.copytree(written, torn)
        (torn / name).unlink()
        with pytest.raises(UserError, match=r"not a whole set of waveforms: \w+: 1 of 1 chunks"):
            open_waveforms(torn)
    (tmp_path / "empty.zarr").mkdir()
    with pytest.raises(UserError, match="no zarr of ours"):
        open_waveforms(tmp_path / "empty.zarr")


def test_a_writer_that_stops_leaves_nothing_and_the_old_stays(
    run: FlownRun, written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "a.zarr"
    shutil.copytree(written, output)
    before = contents(output)

    def full(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(store, "_digest", full)
    with pytest.raises(OSError, match="No space left"):
        write_waveforms(run, output, pixels=ALL, frames=range(1), overwrite=True)
    assert contents(output) == before
    assert [path.name for path in tmp_path.iterdir()] == ["a.zarr"]


def test_a_frame_that_is_not_the_run_s_own_is_refused(run: FlownRun, tmp_path: Path) -> None:
    shutil.copytree(run.folder, tmp_path / "run")
    other = FlownRun.open(tmp_path / "run")
    shutil.copy(run.folder / "frames/000001.npz", tmp_path / "run/frames/000002.npz")
    with pytest.raises(
        OtherRunError, match=r"000002\.npz: flown again, the frame differs in bottom_"
    ):
        write_waveforms(other, tmp_path / "a.zarr", pixels=ALL)
    assert not list(tmp_path.glob("*.zarr"))


def test_an_export_writes_the_same_waveforms(run: FlownRun, written: Path, tmp_path: Path) -> None:
    words = ["export", str(run.folder), "--to", "zarr", "-o", str(tmp_path / "out")]
    exported = CliRunner().invoke(app, words)
    assert exported.exit_code == 0, exported.output
    assert contents(tmp_path / "out/waveforms.zarr") == contents(written)
    blind = CliRunner().invoke(app, [*words, "--standard-only"])
    assert (blind.exit_code, "zarr is waveforms labelled with the truth" in blind.stderr) == (
        2,
        True,
    )


def typed(*words: object) -> Result:
    return CliRunner().invoke(app, ["waveforms", *map(str, words)])


def test_the_command_writes_what_is_not_there_and_draws(
    run: FlownRun, written: Path, tmp_path: Path
) -> None:
    output, picture = tmp_path / "a.zarr", tmp_path / "a.png"
    words = (run.folder, "-o", output, "--every", 4, "--frames", "1:2")
    shutil.copytree(written, output)
    other = typed(*words)
    assert (other.exit_code, "another run, other frames" in other.stderr) == (2, True)
    (output / "counts" / "0.0.0.0").unlink()
    half = typed(*words)
    assert (half.exit_code, "not a whole set" in half.stderr) == (2, True)
    new = typed(*words, "--overwrite")
    assert (new.exit_code, "1 x 1 x 2" in new.stdout) == (0, True)
    assert open_waveforms(output).sizes["frame"] == 1
    assert "there already, and whole" in typed(*words).stdout
    assert typed(run.folder, "--pixel", "1,2,5", "--plot", picture).exit_code == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "status", "text"),
    [
        ((), 2, "nothing to do"),
        (("-o", "x.zarr", "--frames", "0:9"), 2, "no such frames. The mission has 0:3"),
        (("-o", "x.zarr", "--every", "9"), 2, "leaves no pixel"),
        (("-o", "x.zarr", "--every", "2", "--pixels", "0:1,0:1"), 2, "give one of them"),
        (("-o", "x.zarr", "--pixels", "0:5,0:1"), 2, "rows 0:4 and columns 0:8"),
        (("-o", "no/x.zarr"), 2, "there is no folder no"),
        (("--pixel", "0,0,0"), 2, "go together"),
        (("--pixel", "0,0", "--plot", "x.png"), 2, "Write FRAME,ROW,COLUMN"),
        (("--pixel", "0,4,0", "--plot", "x.png"), 2, "no pixel in row 4"),
        (("--pixel", "7,0,0", "--plot", "x.png"), 2, "not in the run"),
        (("--pixel", "0,0,0", "--plot", "x.pdf"), 2, ".png or .svg"),
    ],
)
def test_bad_words_are_answered(
    run: FlownRun, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    words: tuple[str, ...], status: int, text: str,
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    result = typed(run.folder, *words)
    assert result.exit_code == status
    assert text in result.stderr
    assert "Traceback" not in result.output
    assert not list(tmp_path.iterdir())


def test_folders_that_are_no_runs_are_named(run: FlownRun, tmp_path: Path) -> None:
    missing = typed(tmp_path / "nowhere", "-o", tmp_path / "a.zarr")
    assert (missing.exit_code, "no such run folder" in missing.stderr) == (3, True)
    empty = typed(tmp_path, "-o", tmp_path / "a.zarr")
    assert (empty.exit_code, "holds no run" in empty.stderr) == (2, True)
    shutil.copytree(run.folder, tmp_path / "run")
    (tmp_path / "run/frames/000001.npz").write_bytes(b"half")
    part = typed(tmp_path / "run", "-o", tmp_path / "a.zarr", "--frames", "0:3")
    assert (part.exit_code, "frames 1: not in the run" in part.stderr) == (2, True)
    shutil.rmtree(tmp_path / "run/frames")
    bare = typed(tmp_path / "run", "-o", tmp_path / "a.zarr")
    assert (bare.exit_code, "no whole frame" in bare.stderr) == (2, True)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/thesis.txt").write_text("years")
    strange = typed(run.folder, "-o", tmp_path / "mine", "--overwrite")
    assert (strange.exit_code, "holds something else" in strange.stderr) == (2, True)
    assert (tmp_path / "mine/thesis.txt").exists()


def test_the_page_s_example_gives_training_pairs(
    written: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (example,) = re.findall(r"```python\n(.+?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    shutil.copytree(written, tmp_path / "sandbar.zarr")
    monkeypatch.chdir(tmp_path)
    got: dict[str, Any] = {}
    exec(example, got)
    histogram, place, share = got["histogram"], got["place"], got["share"]
    assert histogram.shape == share.shape == (len(place), 300)
    assert len(place) > 50
    strongest = share.argmax(axis=1)
    assert np.abs(strongest - place).max() < 8.0
    bins = np.arange(300)
    near = np.abs(bins - place[:, None]) < 12.0
    assert (histogram.max(axis=1, where=near, initial=0) > 0).all()
