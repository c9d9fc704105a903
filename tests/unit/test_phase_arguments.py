"""Phase functions: tables of users and arguments out of range."""

from __future__ import annotations

import numpy as np
import pytest

from survey.errors import UserError
from survey.optics.phase import (
    fournier_forand,
    fournier_forand_of_backscatter,
    henyey_greenstein,
    mixture,
    molecular,
    petzold,
    read_phase_function,
    tabled_phase_function,
    two_term_henyey_greenstein,
)


@pytest.fixture
def table(tmp_path):
    """Return a function that writes a table and gives its path."""

    def write(text):
        path = tmp_path / "mine.csv"
        path.write_text(text)
        return path

    return write


def faults_of(path, **arguments):
    with pytest.raises(UserError) as error:
        read_phase_function(path, **arguments)
    return str(error.value).replace(f"{path}: ", "").splitlines()


def test_table_is_read_in_any_unit(table):
    """Isotropic light in a file with comments, blank lines and CRLF: 1 / (4 pi)."""
    path = table("# mine\r\nangle_deg,value\r\n0,3\r\n\r\n90, 3 # middle\r\n180,3\r\n")
    phase = read_phase_function(path)
    assert phase.name == "mine.csv"
    assert phase.density([0.0, 1.0, np.pi]) == pytest.approx(1 / (4 * np.pi), rel=1e-6)


def test_table_from_zero_is_followed_in_its_first_interval(table):
    """exp(-3 angle) given every 0.2 rad from 0 on: the peak is the table's, not a power law's."""
    angles = np.linspace(0.0, np.pi, 17)
    rows = "\n".join(f"{np.degrees(a)},{np.exp(-3 * a)}" for a in angles)
    phase = read_phase_function(table(f"angle_deg,value\n{rows}\n"))
    ratio = float(phase.density(0.05) / phase.density(0.1))
    assert ratio == pytest.approx(np.exp(0.15), rel=1e-3)


def test_table_of_petzold_is_petzold(table):
    """Written out from 0.1 degrees with the report's slope stated, read again: the same."""
    phase = petzold("coastal")
    degrees = np.degrees(np.geomspace(np.radians(0.1), np.pi, 3000))
    rows = "\n".join(f"{d!r},{float(phase.density(np.radians(d)))!r}" for d in map(float, degrees))
    path = table(f"angle_deg,value\n{rows}\n")
    again = read_phase_function(path, small_angle_slope=-1.545)
    assert again.mean_cosine == pytest.approx(phase.mean_cosine, abs=1e-5)
    assert again.fraction_within(1e-4) == pytest.approx(phase.fraction_within(1e-4), rel=1e-3)
    # Unstated, the slope of the first two rows goes on: that of the table's first interval.
    continued = read_phase_function(path)
    assert continued.small_angle_slope == pytest.approx(-1.5456, abs=0.001)


def test_every_fault_with_its_line(table):
    path = table("angle_deg,value\n10,1\n5,2\n20,-3\nabc,1\n30,nan\n40,inf\n190,1\n50\n")
    assert faults_of(path) == [
        "line 3: angle 5 deg after 10: angles must ascend. Sort the rows",
        "line 4: value -3: must be positive and finite",
        "line 5: 'abc,1': must be two numbers with a comma between",
        "line 6: value nan: must be positive and finite",
        "line 7: value inf: must be positive and finite",
        "line 8: angle 190 deg: must lie in 0 to 180",
        "line 8: the table ends at 190 deg: must reach 180",
        "line 9: '50': must be two numbers with a comma between",
    ]


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("", "line 1: a table needs at least two rows"),
        ("angle_deg,value\n180,1\n", "line 2: a table needs at least two rows"),
        ("degrees,p\n0,1\n180,1\n", "line 1: 'degrees,p': must be the header angle_deg,value"),
        ("angle_deg,value\n0,1\n170,1\n", "line 3: the table ends at 170 deg: must reach 180"),
        ("angle_deg,value\n0,1\n0,1\n180,1\n", "line 3: angle 0 deg after 0: angles must ascend"),
        ("angle_deg,value\n1,8\n2,1\n180,1\n", "line 2: below its first angle the table goes on"),
    ],
)
def test_one_fault(table, text, fault):
    (line,) = faults_of(table(text))
    assert line.startswith(fault)


def test_stated_slope_must_have_an_integral(table):
    path = table("angle_deg,value\n1,8\n180,1\n")
    assert "angle^-2.5, which has no integral" in faults_of(path, small_angle_slope=-2.5)[0]
    assert read_phase_function(path, small_angle_slope=-1.9).mean_cosine > 0.0


def test_files_that_are_no_tables(tmp_path):
    with pytest.raises(UserError, match=r"absent\.csv: cannot be read"):
        read_phase_function(tmp_path / "absent.csv")
    with pytest.raises(UserError, match="cannot be read"):
        read_phase_function(tmp_path)
    binary = tmp_path / "image.csv"
    binary.write_bytes(b"\xff\xfe\x00\x80" * 10)
    with pytest.raises(UserError, match="is not text"):
        read_phase_function(binary)


@pytest.mark.parametrize(
    ("make", "named"),
    [
        (lambda: henyey_greenstein(1.0), ["asymmetry = 1"]),
        (lambda: henyey_greenstein(float("nan")), ["asymmetry = nan"]),
        (
            lambda: two_term_henyey_greenstein(
                forward_share=1.1, forward_asymmetry=2.0, backward_asymmetry=-1.0
            ),
            ["forward_share = 1.1", "forward_asymmetry = 2", "backward_asymmetry = -1"],
        ),
        (lambda: molecular(-0.1), ["depolarisation = -0.1"]),
        (
            lambda: fournier_forand(particle_index=1.0, size_slope=3.0),
            ["particle_index = 1", "size_slope = 3"],
        ),
        (lambda: fournier_forand_of_backscatter(0.6), ["backscatter_fraction = 0.6"]),
        (lambda: fournier_forand_of_backscatter(0.0), ["backscatter_fraction = 0"]),
        (lambda: mixture([(molecular(), -1.0), (petzold("clear"), np.inf)]), ["-1", "inf"]),
        (lambda: mixture([(molecular(), 0.0)]), ["no component scatters"]),
        (lambda: mixture([]), ["no component scatters"]),
        (
            lambda: tabled_phase_function(name="t", angle=[0.2, 0.1], value=[1.0, 0.0]),
            ["row 2: value 0", "row 2: angle", "must reach 180"],
        ),
    ],
)
def test_arguments_out_of_range_are_all_named(make, named):
    with pytest.raises(ValueError) as error:  # noqa: PT011  # the texts are what is tested
        make()
    for part in named:
        assert part in str(error.value)
