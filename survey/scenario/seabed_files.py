"""What the section [seabed] names as files: elevations, points, meshes, a map."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from survey.scenario import seabed_sections as kinds
from survey.scenario.scenario import Scenario
from survey.scenario.seabed_materials import stated_reflectance, substrate_of
from survey.scenario.seabed_object_sections import MeshObject
from terrain.map_frame import MapFrame

if TYPE_CHECKING:
    from terrain.cover import Cover
    from terrain.roughness import Roughness
    from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]


def require_readable_files(scenario: Scenario) -> None:
    """Read every file that a scenario's seabed names, as far as it is flown.

    Raises
    ------
    SeabedFileError
        With the faults of all of them, a line each.
    """
    readers = list(_readers(scenario))
    if not readers:
        return
    from terrain.file_faults import SeabedFileError

    faults = []
    for read in readers:
        try:
            read()
        except SeabedFileError as fault:
            faults.append(str(fault))
    if faults:
        raise SeabedFileError("\n".join(faults))


def _readers(scenario: Scenario) -> Iterator[Callable[[], object]]:
    given = scenario.seabed
    from_file = isinstance(given, kinds.RasterSeabed | kinds.PointsSeabed | kinds.MeshSeabed)
    if from_file or given.map is not None:
        from survey.scenario.components import map_frame, view_outlines

        frame = map_frame(scenario)
        corners = np.concatenate(view_outlines(scenario)) + frame.origin[:2]
        if from_file:
            yield partial(imported, scenario, corners, frame)
        if given.map is not None:
            yield partial(cover, given.map, scenario, corners)
    for part in given.objects:
        if isinstance(part, MeshObject):
            from terrain.importers import read_mesh

            yield partial(read_mesh, scenario.folder / part.file)


def roughness(given: kinds.RoughenedSeabed) -> Roughness | None:
    """Return the synthetic relief of a seabed; None where there is none."""
    from terrain.roughness import Roughness

    if given.roughness_rms_m == 0.0:
        return None
    return Roughness(
        rms=given.roughness_rms_m,
        spectral_slope=given.roughness_spectral_slope,
        longest_wavelength=given.roughness_longest_wave_m,
        seed=given.roughness_seed,
    )


def imported(scenario: Scenario, corners: FloatArray, frame: MapFrame) -> Seabed:
    """Return the seabed of a file in a local frame.

    Parameters
    ----------
    scenario : Scenario
    corners : array (n, 2)
        On the map [m]: what lies beyond their margin is not needed.
    frame : MapFrame
    """
    seabed = _imported(scenario, corners)
    mesh = seabed.mesh.copy()
    mesh.apply_translation(seabed.map_frame.origin - frame.origin)
    return replace(seabed, mesh=mesh, map_frame=frame)


def _imported(scenario: Scenario, corners: FloatArray) -> Seabed:
    from terrain import importers

    given, mission = scenario.seabed, scenario.mission
    common: dict[str, Any] = {
        "epsg": mission.crs_epsg,
        "vertical_epsg": mission.vertical_epsg,
        "reflectance": stated_reflectance(given.model_dump()),
    }
    nearby: dict[str, Any] = {"outline": corners, "margin": given.margin_m}
    if isinstance(given, kinds.RasterSeabed):
        return importers.from_raster(
            scenario.folder / given.file,
            band=given.band,
            nodata=given.nodata,
            spacing=given.spacing_m,
            roughness=roughness(given),
            **nearby,
            **common,
        )
    if isinstance(given, kinds.PointsSeabed):
        return importers.from_las(
            scenario.folder / given.file,
            classes=given.classes,
            cell=given.cell_m,
            longest_edge=given.longest_edge_m,
            **nearby,
            **common,
        )
    assert isinstance(given, kinds.MeshSeabed)
    offset = (given.offset_easting_m, given.offset_northing_m, given.offset_up_m)
    return importers.from_mesh_file(scenario.folder / given.file, offset=offset, **common)


def cover(given: kinds.BottomMap, scenario: Scenario, corners: FloatArray) -> Cover:
    """Return what a map shows about corners (n, 2) on the map [m]."""
    from terrain.cover import reflectance_cover, substrate_cover

    path = scenario.folder / given.file
    window: dict[str, Any] = {
        "epsg": scenario.mission.crs_epsg,
        "band": given.band,
        "nodata": given.nodata,
        "outline": corners,
        "margin": scenario.seabed.margin_m,
    }
    if not given.classes:
        return reflectance_cover(path, **window)
    classes = {part.value: substrate_of(part, scenario.seabed) for part in given.classes}
    return substrate_cover(path, classes=classes, **window)
