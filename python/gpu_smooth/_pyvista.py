"""Meshes of PyVista."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from gpu_smooth._cells import REGIONS, Cells, whole
from gpu_smooth._ends import ends_of_numbers
from gpu_smooth._errors import MeshError

# Types of VTK's cells.
VERTEX, POLY_VERTEX, LINE, POLY_LINE, TRIANGLE, QUAD = 1, 2, 3, 4, 5, 9


class _Part:
    """Cells of one type: the vertices of cell k are `connectivity[offsets[k]:offsets[k + 1]]`."""

    def __init__(self, offsets: Any, connectivity: Any) -> None:
        self.offsets, self.connectivity = np.asarray(offsets), np.asarray(connectivity)
        self.sizes = np.diff(self.offsets)

    def rows(self, is_chosen: Any, size: int) -> Any:
        """Return the vertices of the chosen cells, which have `size` vertices each."""
        starts = self.offsets[:-1][is_chosen]
        return self.connectivity[starts[:, None] + np.arange(size)].astype(np.int64)

    def vertices(self, is_chosen: Any) -> Any:
        """Return the vertices of the chosen cells."""
        return self.connectivity[np.repeat(is_chosen, self.sizes)].astype(np.int64)

    def segments(self, is_chosen: Any) -> Any:
        """Return the edges of the chosen lines and polylines, of shape (k, 2)."""
        edges = np.stack([self.connectivity[:-1], self.connectivity[1:]], axis=1).astype(np.int64)
        # An edge does not go from one line to the next.
        is_inside = np.repeat(is_chosen, self.sizes)[:-1]
        ends = self.offsets[1:-1] - 1
        is_inside[ends[(ends >= 0) & (ends < len(is_inside))]] = False
        return edges[is_inside]


def _part(array: Any) -> _Part:
    """Return the cells of a `vtkCellArray`."""
    import pyvista

    return _Part(
        pyvista.convert_array(array.GetOffsetsArray()),
        pyvista.convert_array(array.GetConnectivityArray()),
    )


def cells_of(mesh: Any) -> Cells:
    """Return the cells of a `pyvista.UnstructuredGrid` or `pyvista.PolyData`."""
    import pyvista

    if isinstance(mesh, pyvista.UnstructuredGrid):
        part, types = _part(mesh.GetCells()), np.asarray(mesh.celltypes)
        is_line = np.isin(types, (LINE, POLY_LINE))
        is_triangle, is_quad = types == TRIANGLE, types == QUAD
        lines = part.segments(is_line) if len(types) else np.empty((0, 2), np.int64)
        is_line_cell, line_sizes = is_line, part.sizes
        anchored = part.vertices(~(is_line | is_triangle | is_quad))
        triangles, quadrilaterals = part.rows(is_triangle, 3), part.rows(is_quad, 4)
    elif isinstance(mesh, pyvista.PolyData):
        # Cell data are of vertices, lines, polygons and strips, in this order.
        parts = [_part(own()) for own in (mesh.GetVerts, mesh.GetLines, mesh.GetPolys, mesh.GetStrips)]
        vertices, polylines, polygons, strips = parts
        is_three, is_four = polygons.sizes == 3, polygons.sizes == 4
        triangles, quadrilaterals = polygons.rows(is_three, 3), polygons.rows(is_four, 4)
        lines = polylines.segments(np.ones(len(polylines.sizes), bool))
        anchored = np.concatenate(
            [vertices.connectivity, strips.connectivity, polygons.vertices(~(is_three | is_four))]
        )
        is_triangle, is_quad = (
            np.concatenate([chosen if own is polygons else np.zeros(len(own.sizes), bool) for own in parts])
            for chosen in (is_three, is_four)
        )
        is_line_cell = np.concatenate([np.full(len(own.sizes), own is polylines) for own in parts])
        line_sizes = np.concatenate([own.sizes for own in parts])
    else:
        raise MeshError(
            f"mesh: {type(mesh).__name__} is not accepted. Pass an UnstructuredGrid or PolyData, such as mesh.cast_to_"
            "unstructured_grid()"
        )
    regions = next((mesh.cell_data[name] for name in REGIONS if name in mesh.cell_data), None)
    of_elements = None
    if regions is not None:
        numbers = np.asarray(regions)
        of_elements = whole(np.concatenate([numbers[is_triangle], numbers[is_quad]]))
    of_lines = None if regions is None else whole(np.asarray(regions)[is_line_cell])
    ends = np.empty(0, np.int64)
    if of_lines is not None:
        # Lines of fewer than two vertices have no edges.
        ends = ends_of_numbers(lines, np.repeat(of_lines, np.maximum(line_sizes[is_line_cell] - 1, 0)))
    return Cells(triangles, lines, anchored.astype(np.int64), of_elements, quadrilaterals, ends)


def points_of(mesh: Any) -> Any:
    """Return the points of a PyVista mesh, of shape (n, 3)."""
    return np.asarray(mesh.points)


def groups_of(mesh: Any) -> dict[str, Callable[[], Any]]:
    """Return no groups: meshes of PyVista have no names for vertices."""
    return {}


def ends_of(mesh: Any, cells: Cells) -> Any:
    """Return the vertices at which lines of one number end."""
    return cells.ends


def with_points(mesh: Any, points: Any, surface: str) -> Any:
    """Return a copy of a PyVista mesh with moved vertices."""
    moved = mesh.copy(deep=True)
    moved.points = points
    return moved
