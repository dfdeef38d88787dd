"""Meshes of other packages and of files in place of arrays."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gpu_smooth import _native
from gpu_smooth._cells import Cells, with_groups
from gpu_smooth._errors import MeshError
from gpu_smooth._files import MeshFile

if TYPE_CHECKING:
    from gpu_smooth._options import Integers


class MeshArrays(NamedTuple):
    """A mesh of another package or of a file as arguments of `smooth`."""

    points: Any
    """Positions of the vertices, of shape (n, 2) or (n, 3)."""
    triangles: Integers
    """Vertices of each triangle, of shape (m, 3)."""
    options: dict[str, Any]
    """Options with the quadrilaterals, fixed vertices, lines and regions of the mesh."""
    with_points: Callable[[Any], Any] | None
    """Function that returns the mesh with other points; None for a `MeshFile`, which does not change."""


def arrays_of(mesh: Any, options: dict[str, Any]) -> MeshArrays:
    """Return a mesh as arguments of `smooth`, with the constraints of its cells beside the given options."""
    package = _package_of(mesh)
    options = with_groups(options, lambda: package.groups_of(mesh))
    points = package.points_of(mesh)
    cells = package.cells_of(mesh).proper()
    word = options.pop("quadrilaterals", None)
    cells = cells.choosing(word)
    if options.get("slide"):
        cells = cells._replace(ends=package.ends_of(mesh, cells))
    options = cells.options(options, len(points))
    if cells.interpolated and options.get("untangle"):
        _check_data(cells, points, options.get("surface", "plane"))
    with_points = None
    if not isinstance(mesh, MeshFile):
        with_points = functools.partial(package.with_points, mesh, surface=options.get("surface", "plane"))
    return MeshArrays(points, cells.triangles, options, with_points)


def _check_data(cells: Cells, points: Any, surface: str) -> None:
    """Raise an error if data of vertices cannot be interpolated, as triangles of the mesh are inverted or flat."""
    try:
        elements = (cells.triangles, cells.quadrilaterals)
        _native.interpolate(points, elements, points, np.zeros(len(points)), surface, "coordinate")
    except MeshError as error:
        if error.triangles:
            bad = f"{len(error.triangles)} triangles are inverted or flat, the first is triangle {error.triangles[0]}"
        elif error.quadrilaterals:
            count = len(error.quadrilaterals)
            bad = f"{count} quadrilaterals are not convex, the first is quadrilateral {error.quadrilaterals[0]}"
        else:
            raise
        refused = MeshError(
            f"mesh: data of nodes ({', '.join(cells.interpolated)}) cannot be interpolated, as {bad}. Pass the grid alone, and "
            "take the data at its new nodes from their source"
        )
        refused.triangles, refused.quadrilaterals = error.triangles, error.quadrilaterals
        raise refused from error


def smooth(mesh: Any, options: dict[str, Any]) -> Any:
    """Smooth a mesh, and return a mesh of the same kind; the new points of a `MeshFile`."""
    points, triangles, options, with_points = arrays_of(mesh, options)
    moved = _native.smooth(points, triangles, **options)
    return moved if with_points is None else with_points(moved)


def points_and_cells(mesh: Any) -> tuple[Any, Cells]:
    """Return the points and the cells of a mesh."""
    package = _package_of(mesh)
    cells: Cells = package.cells_of(mesh).proper()
    return package.points_of(mesh), cells


def _package_of(mesh: Any) -> Any:
    """Return the module for the meshes of a package."""
    if isinstance(mesh, MeshFile):
        from gpu_smooth import _mesh_files

        return _mesh_files
    if isinstance(mesh, (str, os.PathLike)):
        raise TypeError(
            "points and triangles are needed, not the name of a file. gpu_smooth.MeshFile reads a file, and "
            "gpu_smooth.smooth_file smooths one"
        )
    # The package of a mesh is imported already, so that no package is imported for a wrong argument.
    packages = {kind.__module__.partition(".")[0] for kind in type(mesh).__mro__}
    if "meshio" in packages:
        from gpu_smooth import _meshio

        return _meshio
    if "pyvista" in packages:
        from gpu_smooth import _pyvista

        return _pyvista
    if "skfem" in packages:
        from gpu_smooth import _skfem

        return _skfem
    if "meshkernel" in packages:
        from gpu_smooth import _meshkernel

        return _meshkernel
    if "xugrid" in packages:
        from gpu_smooth import _xugrid

        return _xugrid
    raise TypeError(
        "points and triangles are needed, or a mesh of meshio, PyVista, scikit-fem, MeshKernel or xugrid, or a MeshFile, not an "
        f"object of type {type(mesh).__name__}"
    )
