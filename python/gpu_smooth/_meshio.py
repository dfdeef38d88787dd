"""Meshes of meshio."""

from __future__ import annotations

import copy
import functools
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from gpu_smooth._cells import REGIONS, Cells, whole, with_groups
from gpu_smooth._ends import ends_of_lines, ends_of_numbers, ends_of_vertices
from gpu_smooth._errors import MeshError


def cells_of(mesh: Any) -> Cells:
    """Return the cells of a `meshio.Mesh`."""
    of_kind = {kind: [k for k, block in enumerate(mesh.cells) if block.type == kind] for kind in ("triangle", "quad", "line")}
    triangles, quadrilaterals, lines = ([_vertices(mesh.cells[k]) for k in own] for own in of_kind.values())
    others = [_vertices(block).ravel() for block in mesh.cells if block.type not in of_kind]
    regions = None
    for name in REGIONS:
        if name in mesh.cell_data:
            own = [np.asarray(mesh.cell_data[name][k]) for k in (*of_kind["triangle"], *of_kind["quad"])]
            regions = whole(np.concatenate(own)) if own else None
            break
    return Cells(
        np.concatenate([np.empty((0, 3), np.int64), *triangles]),
        np.concatenate([np.empty((0, 2), np.int64), *lines]),
        np.concatenate([np.empty(0, np.int64), *others]),
        regions,
        np.concatenate([np.empty((0, 4), np.int64), *quadrilaterals]),
    )


def _vertices(block: Any) -> Any:
    """Return the vertices of the cells of a block, of shape (k, n); of polyhedra, in one row."""
    if block.type.startswith("polyhedron"):
        corners = [np.asarray(face).ravel() for cell in block.data for face in cell]
        vertices = np.concatenate([np.empty(0, np.int64), *corners])
    else:
        vertices = np.asarray(block.data)
    if vertices.dtype.kind not in "iu" and vertices.size:
        raise MeshError(
            f"mesh: vertices of cells are integers, but those of type {block.type} are numbers of type {vertices.dtype}. "
            "Convert the data of their block by .astype(int)"
        )
    return vertices.astype(np.int64)


def groups_of(mesh: Any) -> dict[str, Callable[[], Any]]:
    """Return the named groups of a `meshio.Mesh`: sets of points, sets of cells and gmsh's physical groups."""

    def of_cells(chosen: Iterable[Any]) -> Any:
        pairs = [(block, own) for block, own in zip(mesh.cells, chosen) if own is not None]
        own = [np.asarray(block.data)[np.asarray(own)].ravel() for block, own in pairs if len(own)]
        return np.concatenate([np.empty(0, np.int64), *own])

    def of_tag(tag: int, dimension: int) -> Any:
        numbers = mesh.cell_data["gmsh:physical"]
        return of_cells(
            np.flatnonzero(np.asarray(own) == tag) if block.dim == dimension else None
            for block, own in zip(mesh.cells, numbers)
        )

    groups: dict[str, Callable[[], Any]] = {}
    if "gmsh:physical" in mesh.cell_data:
        for name, (tag, dimension) in mesh.field_data.items():
            groups[name] = functools.partial(of_tag, tag, dimension)
    for name, chosen in mesh.cell_sets.items():
        groups[name] = functools.partial(of_cells, chosen)
    for name, points in mesh.point_sets.items():
        groups[name] = functools.partial(np.asarray, points)
    return groups


def ends_of(mesh: Any, cells: Cells) -> Any:
    """Return the vertices at which groups of a `meshio.Mesh` end: numbers of lines, sets of cells and sets of points."""
    blocks = [(k, _vertices(block)) for k, block in enumerate(mesh.cells) if block.type == "line"]
    found = [np.empty(0, np.int64)]
    for name in REGIONS:
        if blocks and name in mesh.cell_data:
            numbers = whole(np.concatenate([np.asarray(mesh.cell_data[name][k]) for k, _ in blocks]))
            if numbers is not None:
                # gmsh writes 0 for lines without a group.
                is_in = (numbers != 0) | (not name.startswith("gmsh:"))
                found.append(ends_of_numbers(cells.lines[is_in], numbers[is_in]))
    for name, chosen in mesh.cell_sets.items():
        # Such sets have tags of the model of gmsh in place of cells.
        if name.startswith("gmsh:"):
            continue
        own = [lines[np.asarray(chosen[k], np.int64)] for k, lines in blocks if chosen[k] is not None]
        found.append(ends_of_lines(np.concatenate([np.empty((0, 2), np.int64), *own])))
    for points in mesh.point_sets.values():
        found.append(ends_of_vertices(np.asarray(points, np.int64), cells.boundary(), cells.lines))
    return np.concatenate(found)


def points_of(mesh: Any) -> Any:
    """Return the points of a `meshio.Mesh`."""
    return np.asarray(mesh.points)


def with_points(mesh: Any, points: Any, surface: str) -> Any:
    """Return a copy of a `meshio.Mesh` with moved vertices. The copy shares cells and data with the mesh."""
    moved = copy.copy(mesh)
    moved.points = points
    return moved
