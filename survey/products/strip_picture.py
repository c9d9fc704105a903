"""A picture of how strips differ before and after an adjustment."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import numpy as np

from survey.products.writing import write_whole

DOTS_PER_INCH = 110
LIMIT_PERCENTILE = 98.0
MOST_CELLS = 2000


def write_strip_picture(path: Path, before: Path, after: Path) -> None:
    """Draw two rasters of `strip_differences_tif` in one scale, as PNG."""
    import rasterio
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    maps, extents = [], []
    for file in (before, after):
        with rasterio.open(file) as raster:
            step = -(-max(raster.shape) // MOST_CELLS)
            shape = (-(-raster.height // step), -(-raster.width // step))
            maps.append(raster.read(1, out_shape=shape))
            extents.append(
                (raster.bounds.left, raster.bounds.right, raster.bounds.bottom, raster.bounds.top)
            )
    sizes = np.abs(maps[0][np.isfinite(maps[0])])
    limit = float(np.percentile(sizes, LIMIT_PERCENTILE)) if sizes.size else 1.0
    figure = Figure(figsize=(9.0, 9.0), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(2, 1, sharex=True, sharey=True)
    for axes, extent, values, words in zip(
        panels, extents, maps, ("as flown", "adjusted"), strict=True
    ):
        image = axes.imshow(
            values,
            cmap="RdBu",
            vmin=-limit,
            vmax=limit,
            extent=extent,
            interpolation="nearest",
        )
        rms = float(np.sqrt(np.nanmean(values**2))) if np.isfinite(values).any() else 0.0
        axes.set_title(f"{words}: {rms:.3f} m r.m.s.", loc="left")
        axes.set_aspect("equal")
        axes.ticklabel_format(useOffset=False, style="plain")
        axes.set_ylabel("northing [m]")
    panels[1].set_xlabel("easting [m]")
    figure.colorbar(image, ax=panels, label="last less first line [m]", extend="both")
    png = BytesIO()
    figure.savefig(png, format="png", dpi=DOTS_PER_INCH, metadata={"Software": None})
    write_whole(path, png.getvalue())
