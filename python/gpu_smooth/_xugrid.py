"""Meshes of xugrid."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import numpy as np

from gpu_smooth import _native
from gpu_smooth._cells import Cells, of_faces
from gpu_smooth._errors import MeshError, warn


def _grid_of(mesh: Any) -> Any:
    """Return a `xugrid.Ugrid2d`, or the only one of a `xugrid.UgridDataset` or `xugrid.UgridDataArray`."""
    import xugrid

    grids = mesh.grids if isinstance(mesh, (xugrid.UgridDataset, xugrid.UgridDataArray)) else [mesh]
    found = [grid for grid in grids if isinstance(grid, xugrid.Ugrid2d)]
    if len(found) != 1:
        raise MeshError(
            f"mesh: one xugrid.Ugrid2d is needed, but the {type(mesh).__name__} has {len(found)}. Pass one grid of mesh.grids, or "
            "data on one grid"
        )
    return found[0]


def points_of(mesh: Any) -> Any:
    """Return the nodes of a grid, of shape (n, 2)."""
    return np.asarray(_grid_of(mesh).node_coordinates)


def cells_of(mesh: Any) -> Cells:
    """Return the cells of a grid: its faces, on the sphere if the grid is geographic."""
    grid = _grid_of(mesh)
    faces = np.asarray(grid.face_node_connectivity, np.int64)
    cells = of_faces(faces, "sphere" if grid.is_geographic else None)
    return cells._replace(interpolated=() if mesh is grid else _of_nodes(mesh.obj, grid))


def groups_of(mesh: Any) -> dict[str, Callable[[], Any]]:
    """Return no groups: a grid has no names for nodes."""
    return {}


def ends_of(mesh: Any, cells: Cells) -> Any:
    """Return no vertices: a grid has no groups of lines."""
    return cells.ends


def with_points(mesh: Any, points: Any, surface: str) -> Any:
    """Return a copy of a grid or of data on a grid, with moved nodes.

    Data of nodes are interpolated at the new nodes. Other data stay, and are shared with the given mesh.
    """
    grid = _grid_of(mesh)
    # As Ugrid2d.to_crs does: the variables that the grid was read from have the old nodes, and the rest is computed anew.
    moved = copy.copy(grid)
    moved.node_x, moved.node_y = np.ascontiguousarray(points.T)
    moved._clear_geometry_properties()
    moved._dataset = None
    moved._attrs, moved._indexes = dict(grid._attrs), dict(grid._indexes)
    if mesh is grid:
        return moved
    data = mesh.obj
    is_array = not hasattr(data, "data_vars")
    positions = _positions(data, grid, moved)
    new = {name: _interpolated(own, grid, points, surface) for name, own in data.coords.items() if name not in positions}
    data = data.assign_coords({**new, **positions})
    if is_array:
        return type(mesh)(_interpolated(data, grid, points, surface), moved)
    data = data.assign({name: _interpolated(own, grid, points, surface) for name, own in data.data_vars.items()})
    return type(mesh)(data, [moved if own is grid else own for own in mesh.grids])


def _positions(data: Any, grid: Any, moved: Any) -> dict[str, Any]:
    """Return those coordinates of data that are positions of nodes, edges and faces, at the moved nodes."""
    found = {}
    for place, kinds in (
        ("node", ["node_coordinates"]), ("edge", ["edge_coordinates"]), ("face", ["centroids", "circumcenters"])
    ):
        for axis, letter in enumerate("xy"):
            name = grid._indexes.get(f"{place}_{letter}", f"{grid.name}_{place}_{letter}")
            if name not in data.coords:
                continue
            old = data.coords[name]
            # Files may have the coordinates in single precision.
            near = max(1e-9, 4 * np.finfo(old.dtype).eps) if old.dtype.kind == "f" else 1e-9
            kind = next((kind for kind in kinds if np.allclose(getattr(grid, kind)[:, axis], old.values, rtol=near)), None)
            if kind is None:
                warn(
                    f"mesh: the coordinate {name} is not updated, as it has neither centers of mass nor circumcenters of the "
                    f"{place}s"
                )
                found[name] = old
                continue
            found[name] = old.copy(data=np.ascontiguousarray(getattr(moved, kind)[:, axis]).astype(old.dtype))
    return found


def _is_of_nodes(data: Any, grid: Any) -> bool:
    """Return whether data are floating-point numbers of nodes, which are interpolated."""
    return grid.node_dimension in data.dims and data.dtype.kind == "f" and data.size > 0


def _of_nodes(data: Any, grid: Any) -> tuple[str, ...]:
    """Return the names of the data that are interpolated, without positions of nodes."""
    named = {**data.coords, **(data.data_vars if hasattr(data, "data_vars") else {data.name or "data": data})}
    positions = {grid._indexes.get(f"node_{letter}", f"{grid.name}_node_{letter}") for letter in "xy"}
    return tuple(str(name) for name, own in named.items() if name not in positions and _is_of_nodes(own, grid))


def _interpolated(data: Any, grid: Any, points: Any, surface: str) -> Any:
    """Return data with values at the moved nodes; the same data if they are not floating-point numbers of nodes."""
    if not _is_of_nodes(data, grid):
        return data
    axis = data.get_axis_num(grid.node_dimension)
    old = np.moveaxis(data.to_numpy(), axis, 0)
    values = old.reshape(len(points), -1).astype(np.float64)
    cells = cells_of(grid).proper()
    elements = (cells.triangles, cells.quadrilaterals)
    new = _native.interpolate(grid.node_coordinates, elements, points, values, surface, "coordinate")
    # Beside a node without a number, the data stay.
    new = np.where(np.isfinite(new), new, values).reshape(old.shape)
    return data.copy(data=np.moveaxis(new, 0, axis).astype(data.dtype))
