"""Compiled kernels are kept from run to run, and never outlive an edit of any of them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from terrain import kernels

CALLED = """
from terrain.kernels import leaf_kernel

@leaf_kernel
def called(x):
    return x + {added}
"""
CALLER = """
from terrain.called import called
from terrain.kernels import kernel

@kernel
def caller(x):
    return called(x)
"""
TELL = """
from terrain.caller import caller
print(caller(1.0), sum(caller.stats.cache_hits.values()))
"""


@pytest.fixture
def run(tmp_path):
    """Run a caller in a process and a cache of its own; returns its result and its cache hits."""
    room = tmp_path / "sources" / "terrain"
    room.mkdir(parents=True)
    (room / "__init__.py").touch()
    shutil.copy(Path(kernels.__file__), room)
    (room / "caller.py").write_text(CALLER)
    places = {"PYTHONPATH": str(room.parent), "XDG_CACHE_HOME": str(tmp_path / "cache")}

    def run_with(added: float) -> tuple[float, int]:
        (room / "called.py").write_text(CALLED.format(added=added))
        done = subprocess.run(
            [sys.executable, "-c", TELL],
            env=os.environ | places,
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=True,
        )
        result, hits = done.stdout.split()
        return float(result), int(hits)

    return run_with


def test_second_run_does_not_compile_and_an_edit_elsewhere_does(run):
    assert run(added=1.0) == (2.0, 0)
    assert run(added=1.0) == (2.0, 1)
    assert run(added=5.0) == (6.0, 0)


def test_every_kernel_lies_where_an_edit_is_noticed():
    """Modules with kernels are in the hashed folders, and nothing else compiles anything."""
    root = Path(kernels.__file__).resolve().parents[1]
    rooms = [root / room for room in kernels.KERNEL_ROOMS]
    sources = [
        path for name in ("survey", "terrain", "viewer") for path in (root / name).rglob("*.py")
    ]
    texts = {path: path.read_text("utf-8") for path in sources}
    holders = [path for path, text in texts.items() if "from terrain.kernels import" in text]
    assert len(holders) > 20
    assert [path for path in holders if not any(room in path.parents for room in rooms)] == []
    compiling = [path.name for path, text in texts.items() if "jit(" in text]
    assert compiling == ["kernels.py"]


@kernels.leaf_kernel
def less_one(x: float, y: float) -> float:
    """Product less 1."""
    return x * y - 1.0


@kernels.inlined_kernel
def inlined_less_one(x: float, y: float) -> float:
    """Product less 1, copied into the caller."""
    return x * y - 1.0


@kernels.fused_kernel
def fused_and_inlined_less_one(x: float, y: float) -> tuple[float, float]:
    """In one step, and what is copied here in two."""
    return x * y - 1.0, inlined_less_one(x, y)


@kernels.fused_kernel
def fused_less_one(x: float, y: float) -> float:
    """The same, called from a kernel that may multiply and subtract in one step."""
    return less_one(x, y)


def test_a_kernel_rounds_alike_whoever_calls_it_first():
    """(1 + e) (1 - e) - 1 is 0 in two steps and -e^2 in one, as a fused kernel may do it.

    Numba hands the caller's options on to what it compiles for it, unless that states its own:
    where a fused kernel met it first, the seabed lost its watertight edges.
    """
    e = 2.0**-30
    fused_less_one(1.0 + e, 1.0 - e)
    assert less_one(1.0 + e, 1.0 - e) == 0.0


def test_what_is_copied_into_a_kernel_rounds_by_its_own_rules():
    e = 2.0**-30
    one_step, two_steps = fused_and_inlined_less_one(1.0 + e, 1.0 - e)
    assert two_steps == 0.0
    assert one_step in (0.0, -(e**2))  # by what the processor has
    assert inlined_less_one(1.0 + e, 1.0 - e) == 0.0


def test_kernels_that_are_compiled_are_known(monkeypatch, tmp_path):
    less_one(1.0, 1.0)
    assert kernels.compiled_before(less_one)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert not kernels.compiled_before(less_one)
