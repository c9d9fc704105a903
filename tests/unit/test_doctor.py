"""The doctor says what is in order and what to do about the rest."""

from __future__ import annotations

import pytest

from survey import doctor


def nothing() -> None:
    pass


def test_what_is_in_order_is_called_good() -> None:
    findings = {finding.what: finding for finding in doctor.examine(nothing)}
    assert findings["rendering"].good
    assert findings["numpy"].text.startswith("2.")
    assert {"bathyflash", "python", "open3d", "threads", "memory"} <= findings.keys()


def test_failed_rendering_is_a_fault_with_its_remedy() -> None:
    def fail() -> None:
        raise RuntimeError("VTK crashed. Type: apt-get install -y libgl1")

    rendering = doctor.examine(fail)[-1]
    assert not rendering.good
    assert "libgl1" in rendering.text


@pytest.mark.parametrize(
    ("present", "good"),
    [({"open3d"}, True), ({"open3d-cpu"}, True), (set(), False), ({"open3d", "open3d-cpu"}, False)],
)
def test_exactly_one_open3d_is_wanted(
    monkeypatch: pytest.MonkeyPatch, present: set[str], good: bool
) -> None:
    monkeypatch.setattr(doctor, "_version", lambda name: "1.0" if name in present else None)
    findings = {finding.what: finding for finding in doctor.examine(nothing)}
    assert findings["open3d"].good is good
