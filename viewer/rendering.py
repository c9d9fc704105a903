"""Whether this machine can render at all, asked where a crash does no harm."""

from __future__ import annotations

import os
import subprocess
import sys
from functools import cache

from survey.errors import UserError

LIBRARIES = "libexpat1 libegl1 libgl1 libusb-1.0-0 libx11-6 libidn2-0 libudev1 libgomp1"
PROBE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(16, 16))
plotter.set_background("white")
plotter.add_mesh(pyvista.Plane(), color="black", lighting=False)
picture = plotter.screenshot(return_img=True)
raise SystemExit(0 if picture.min() < 128 else 3)
"""
TIMEOUT_S = 120.0


def require_rendering() -> None:
    """Check by a small picture, drawn in a child process, that VTK can render off screen.

    VTK does not raise without the system's GL libraries: it crashes, and would take this process
    with it. The answer is kept for the life of the process.

    Raises
    ------
    RuntimeError
        If nothing can be rendered, with the line that installs what is missing.
    """
    _do_without_display()
    fault = _fault()
    if fault:
        raise RuntimeError(
            f"rendering: {fault}. On Debian or Ubuntu type: apt-get install -y {LIBRARIES}"
        )


def require_display() -> None:
    """Check that there is a display for a window.

    VTK's windows on Linux are those of X11, which Wayland's desktops offer too.

    Raises
    ------
    UserError
        If there is none, or none that answers, with what to do instead.
    """
    if sys.platform != "linux":
        return
    name = os.environ.get("DISPLAY", "")
    fault = _display_fault() if name else "DISPLAY is not set"
    if fault:
        raise UserError(
            f"no display for a window: {fault}. Draw a picture with --screenshot FILE.png, "
            "a page for any browser with --web FILE.html, a fly-over with --movie FILE.mp4"
        )


def _display_fault() -> str:
    """Return why the display that DISPLAY names cannot be used; asked of X11 itself."""
    import ctypes

    try:
        x11 = ctypes.CDLL("libX11.so.6")
    except OSError:
        return "the library libX11.so.6 is missing"
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = x11.XOpenDisplay(None)
    if not display:
        return f"{os.environ['DISPLAY']} does not answer"
    x11.XCloseDisplay(ctypes.c_void_p(display))
    return ""


def _do_without_display() -> None:
    """Have VTK use EGL at once where Linux has no display, rather than look for X and complain."""
    if sys.platform == "linux" and not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


@cache
def _fault() -> str:
    try:
        child = subprocess.run(
            [sys.executable, "-c", PROBE], capture_output=True, timeout=TIMEOUT_S, check=False
        )
    except subprocess.TimeoutExpired:
        return f"no picture within {TIMEOUT_S:.0f} s"
    if child.returncode == 0:
        return ""
    if child.returncode < 0:
        return f"VTK crashed (signal {-child.returncode}), GL libraries are missing"
    last = child.stderr.decode(errors="replace").strip().splitlines()[-1:] or ["blank picture"]
    return f"VTK cannot draw ({last[0]})"
