"""The one decorator of every compiled kernel.

Numba keeps compiled code in a cache that does not notice when a *called* kernel in another file
changes. The cache folder is therefore named by the hash of all kernel sources: an edit of any of
them starts a new folder, and nothing stale can ever be run.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.extending import register_jitable

PLAIN: dict[str, Any] = {"error_model": "numpy", "fastmath": False}
"""Stated for every kernel: what a kernel does not state it takes over from its first caller."""
FUSED: dict[str, Any] = {
    "nogil": True,
    "error_model": "numpy",
    "fastmath": {"contract", "arcp", "nsz"},
    "no_cfunc_wrapper": True,
    "_nrt": False,
}
KERNEL_ROOMS = (
    "terrain",
    "survey/optics",
    "survey/sensor",
    "survey/transport",
    "survey/cloud/kernels",
)

F = TypeVar("F", bound=Callable[..., Any])


def source_fingerprint() -> str:
    """Return the hexadecimal hash of every Python source that may hold a kernel."""
    root = Path(__file__).resolve().parent.parent
    digest = hashlib.sha256()
    for room in KERNEL_ROOMS:
        for path in sorted((root / room).rglob("*.py")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Return the folder of compiled kernels that belongs to the present sources."""
    base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "bathyflash" / "kernels" / source_fingerprint()


setattr(numba.config, "CACHE_DIR", str(cache_folder()))  # noqa: B010  # untyped there


def compiled_before(compiled: Callable[..., Any]) -> bool:
    """Return whether the cache holds machine code of a kernel, from an earlier run or this one."""
    written = compiled.__code__
    name = f"{Path(written.co_filename).stem}.{compiled.__name__}-{written.co_firstlineno}"
    return any(cache_folder().glob(f"*/{name}.*.nbi"))


def kernel(function: F) -> F:
    """Compile ``function`` without the interpreter lock, cached across runs.

    Kernels take scalars, arrays and named tuples, allocate nothing they can be handed, and raise
    nothing: the array function around them checks its arguments first.
    """
    return cast(F, numba.njit(function, nogil=True, cache=True, **PLAIN))


def leaf_kernel(function: F) -> F:
    """Compile a kernel of scalars in, scalars out, that counts no references to its arrays.

    The counting costs some 70 ns a call where a named tuple of arrays is passed on and on. Without
    it a kernel may read and write arrays and call other leaf kernels, but create none.
    """
    compiled = numba.njit(  # type: ignore[call-overload]
        function, nogil=True, cache=True, no_cfunc_wrapper=True, _nrt=False, **PLAIN
    )
    return cast(F, compiled)


def inlined_kernel(function: F) -> F:
    """Let kernels call ``function``: LLVM copies it into them, as a leaf kernel.

    For kernels of many arguments that are called at one place: handing over a few named tuples of
    arrays costs as much as fifty multiplications. Numba's own ``inline`` runs as fast but takes six
    times as long to compile. Python calls the function as it is written.
    """
    return register_jitable(forceinline=True, nogil=True, _nrt=False, **PLAIN)(function)


def fused_kernel(function: F) -> F:
    """Return a leaf kernel that multiplies and adds in one step, as the kernels copied into it do.

    Rounding differs in the last digit from that of two steps, alike in every run on one machine.
    """
    return cast(F, numba.njit(function, cache=True, **FUSED))


def inlined_fused_kernel(function: F) -> F:
    """Let kernels call ``function``: LLVM copies it into them, as a fused kernel."""
    return register_jitable(forceinline=True, **FUSED)(function)
