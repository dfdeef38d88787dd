"""Meshes of files in place of arrays."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from gpu_smooth._cells import Cells
from gpu_smooth._ends import between_regions, boundary_of

if TYPE_CHECKING:
    from gpu_smooth._files import MeshFile


def points_of(file: MeshFile) -> Any:
    """Return the points of a file, of shape (n, 3) if its third coordinates differ."""
    return file._native.points_in_space() if file._native.has_third_coordinates else file.points


def cells_of(file: MeshFile) -> Cells:
    """Return the cells of a file. Vertices that the file constrains stay, apart from those that may slide along lines."""
    triangles, quadrilaterals, lines, regions = file.triangles, file.quadrilaterals, file.lines, file.regions
    on_curves = np.union1d(boundary_of(triangles, quadrilaterals), lines)
    if regions is not None:
        on_curves = np.union1d(on_curves, between_regions(regions, triangles, quadrilaterals, len(file.points)))
    anchored = file._native.anchored_alone
    of_model = np.setdiff1d(np.setdiff1d(file._native.constrained, on_curves), anchored)
    return Cells(triangles, lines, anchored, regions, quadrilaterals, periodic=file.periodic, of_model=of_model)


def groups_of(file: MeshFile) -> dict[str, Callable[[], Any]]:
    """Return the named groups of a file, such as physical groups of gmsh."""
    groups: dict[str, list[Any]] = {}
    for group in file.groups:
        if group.name is not None:
            groups.setdefault(group.name, []).append(group.vertices)
    return {name: functools.partial(np.concatenate, own) for name, own in groups.items()}


def ends_of(file: MeshFile, cells: Cells) -> Any:
    """Return the vertices at which groups of a file end."""
    return file.anchored
