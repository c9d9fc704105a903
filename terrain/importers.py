"""Seabeds from files: rasters, LAS or LAZ points, meshes."""

from terrain.file_faults import SeabedFileError
from terrain.las_import import from_las
from terrain.mesh_import import from_mesh_file, read_mesh
from terrain.raster_import import from_raster

__all__ = ["SeabedFileError", "from_las", "from_mesh_file", "from_raster", "read_mesh"]
