"""Meshes of meshio."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np

from gpu_smooth import _native
from gpu_smooth._cells import REGIONS, Cells, whole


def cells_of(mesh: Any) -> Cells:
    """Return the cells of a `meshio.Mesh`."""
    of_triangles = [block.type == "triangle" for block in mesh.cells]
    triangles = [block.data for block, is_one in zip(mesh.cells, of_triangles) if is_one]
    lines = [block.data for block in mesh.cells if block.type == "line"]
    others = [
        np.asarray(block.data).ravel()
        for block in mesh.cells
        if block.type not in ("triangle", "line")
    ]
    regions = None
    for name in REGIONS:
        if name in mesh.cell_data:
            own = [np.asarray(d) for d, is_one in zip(mesh.cell_data[name], of_triangles) if is_one]
            regions = whole(np.concatenate(own)) if own else None
            break
    return Cells(
        np.concatenate([np.empty((0, 3), np.int64), *triangles]).astype(np.int64),
        np.concatenate([np.empty((0, 2), np.int64), *lines]).astype(np.int64),
        np.concatenate([np.empty(0, np.int64), *others]).astype(np.int64),
        regions,
    )


def smooth(mesh: Any, options: dict[str, Any]) -> Any:
    """Return a copy of a `meshio.Mesh` with moved vertices. The copy shares cells and data with the mesh."""
    cells = cells_of(mesh)
    points = np.asarray(mesh.points)
    smoothed = copy.copy(mesh)
    smoothed.points = _native.smooth(points, cells.triangles, **cells.options(options, len(points)))
    return smoothed
