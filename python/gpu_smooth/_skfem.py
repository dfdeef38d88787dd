"""Meshes of scikit-fem."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable
from typing import Any

import numpy as np

from gpu_smooth._cells import Cells
from gpu_smooth._ends import ends_of_lines
from gpu_smooth._errors import MeshError


def points_of(mesh: Any) -> Any:
    """Return the points of a `skfem.MeshTri` or `MeshQuad`, of shape (n, 2)."""
    return np.ascontiguousarray(np.asarray(mesh.p).T)


def cells_of(mesh: Any) -> Cells:
    """Return the cells of a `skfem.MeshTri` or `MeshQuad`: its elements, the facets of its boundaries, and its subdomains as
    regions."""
    corners = np.asarray(mesh.t)
    # Vertices of further types are no corners of elements, such as the middles of curved edges. Tetrahedra have four vertices too.
    kinds = {kind.__name__ for kind in type(mesh).__mro__}
    is_linear = not kinds & {"MeshTri2", "MeshQuad2"}
    if len(corners) not in (3, 4) or len(mesh.p) != 2 or not is_linear:
        raise MeshError(
            f"mesh: {type(mesh).__name__} is not accepted. Pass a MeshTri or MeshQuad of linear elements, such as MeshTri1"
        )
    lines = [np.empty((0, 2), np.int64), *(_edges(mesh, own) for own in (mesh.boundaries or {}).values())]
    elements, none = np.ascontiguousarray(corners.T).astype(np.int64), np.empty(0, np.int64)
    if len(corners) == 4:
        return Cells(none.reshape(0, 3), np.concatenate(lines), none, _regions(mesh), elements)
    return Cells(elements, np.concatenate(lines), none, _regions(mesh))


def _edges(mesh: Any, facets: Any) -> Any:
    """Return the vertices of facets, of shape (k, 2)."""
    return np.asarray(mesh.facets)[:, np.asarray(facets)].T.astype(np.int64)


def _regions(mesh: Any) -> Any:
    """Return a number for each element, which differs where an element is in other subdomains; None without subdomains."""
    subdomains = mesh.subdomains or {}
    if not subdomains:
        return None
    is_in = np.zeros((len(subdomains), np.asarray(mesh.t).shape[1]), bool)
    for row, own in zip(is_in, subdomains.values()):
        row[np.asarray(own)] = True
    return np.unique(is_in, axis=1, return_inverse=True)[1].ravel()


def groups_of(mesh: Any) -> dict[str, Callable[[], Any]]:
    """Return the boundaries and subdomains of a mesh by their names."""
    corners = np.asarray(mesh.t)
    groups: dict[str, Callable[[], Any]] = {}
    for name, own in (mesh.subdomains or {}).items():
        groups[name] = functools.partial(np.unique, corners[:, np.asarray(own)])
    for name, own in (mesh.boundaries or {}).items():
        groups[name] = functools.partial(np.unique, _edges(mesh, own))
    return groups


def ends_of(mesh: Any, cells: Cells) -> Any:
    """Return the vertices at which boundaries of a mesh end."""
    found = [ends_of_lines(_edges(mesh, own)) for own in (mesh.boundaries or {}).values()]
    return np.concatenate([np.empty(0, np.int64), *found])


def with_points(mesh: Any, points: Any, surface: str) -> Any:
    """Return a copy of a mesh with moved vertices, and with its boundaries and subdomains."""
    return dataclasses.replace(mesh, doflocs=np.ascontiguousarray(points.T))
