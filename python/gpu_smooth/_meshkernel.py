"""Meshes of MeshKernel."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from gpu_smooth._cells import Cells, of_faces
from gpu_smooth._errors import MeshError

if TYPE_CHECKING:
    from gpu_smooth._options import Integers


def points_of(mesh: Any) -> Any:
    """Return the nodes of a `meshkernel.Mesh2d`, of shape (n, 2)."""
    return np.column_stack([mesh.node_x, mesh.node_y])


def cells_of(mesh: Any) -> Cells:
    """Return the cells of a `meshkernel.Mesh2d`: its faces. If the mesh has only edges, MeshKernel finds the faces."""
    return of_faces(_faces(mesh))


def groups_of(mesh: Any) -> dict[str, Callable[[], Any]]:
    """Return no groups: a `meshkernel.Mesh2d` has no names for nodes."""
    return {}


def ends_of(mesh: Any, cells: Cells) -> Any:
    """Return no vertices: a `meshkernel.Mesh2d` has no groups of lines."""
    return cells.ends


def with_points(mesh: Any, points: Any, surface: str) -> Any:
    """Return a copy of a `meshkernel.Mesh2d` with moved nodes. The copy shares edges and faces with the mesh.

    The middles of edges and the centers of faces are computed anew if the mesh has them, the centers by MeshKernel.
    """
    moved = copy.copy(mesh)
    moved.node_x, moved.node_y = _columns(points)
    if len(mesh.edge_x):
        moved.edge_x, moved.edge_y = _columns(points[_edges(mesh)].mean(axis=1))
    if len(mesh.face_x):
        moved.face_x, moved.face_y = _columns(_centers(_faces(mesh), points, surface))
    return moved


def _columns(points: Any) -> tuple[Any, Any]:
    """Return the two coordinates of points as contiguous arrays, as MeshKernel takes no others."""
    x, y = np.ascontiguousarray(points.T, np.float64)
    return x, y


def _edges(mesh: Any) -> Integers:
    """Return the nodes of each edge of a `meshkernel.Mesh2d`, of shape (k, 2)."""
    return _checked(mesh, "edge_nodes").reshape(-1, 2)


def _checked(mesh: Any, name: str) -> Integers:
    """Return an array of node numbers. MeshKernel itself would read memory of others for numbers of no node."""
    numbers = np.asarray(getattr(mesh, name), np.int64).ravel()
    count = len(mesh.node_x)
    unknown = np.flatnonzero((numbers < 0) | (numbers >= count))
    if len(unknown):
        raise MeshError(
            f"mesh: {name}[{unknown[0]}] is {numbers[unknown[0]]}, but the mesh has {count} nodes: nodes are numbered from 0"
        )
    return numbers


def _faces(mesh: Any) -> Integers:
    """Return the nodes of each face, of shape (m, k), with -1 beyond the last node of a face."""
    sizes = np.asarray(mesh.nodes_per_face, np.int64)
    nodes = _checked(mesh, "face_nodes")
    if not len(sizes) and not len(nodes):
        return _faces_between(_edges(mesh), points_of(mesh))
    if sizes.sum() != len(nodes) or sizes.min(initial=3) < 3:
        raise MeshError(
            f"mesh: the numbers in nodes_per_face must be 3 or more and add up to the {len(nodes)} numbers in face_nodes. Their sum "
            f"is {sizes.sum()}, the least is {sizes.min(initial=3)}. Pass a mesh that mesh2d_get returns"
        )
    return _rows(nodes, sizes)


def _rows(nodes: Any, sizes: Any) -> Integers:
    """Return lists of nodes, one after another in an array, as rows with -1 beyond the last node."""
    rows = np.full((len(sizes), sizes.max(initial=3)), -1, np.int64)
    rows[np.arange(rows.shape[1]) < sizes[:, None]] = nodes
    return rows


def _faces_between(edges: Integers, points: Any) -> Integers:
    """Return the faces that MeshKernel finds between edges, as rows of nodes."""
    # MeshKernel removes edges with a loose end, and numbers the other nodes anew.
    while True:
        is_loose = (np.bincount(edges.ravel(), minlength=len(points))[edges] == 1).any(axis=1)
        if not is_loose.any():
            break
        edges = edges[~is_loose]
    if not len(edges):
        return np.empty((0, 3), np.int64)
    return _of_kernel(edges, np.empty((0, 3), np.int64), points, "plane")[0]


def _of_kernel(edges: Integers, faces: Integers, points: Any, surface: str) -> tuple[Integers, Any]:
    """Return MeshKernel's faces, as rows of nodes in its own order, and their centers, of shape (m, 2).

    `faces` are the faces of the mesh, as rows of nodes. If there are none, MeshKernel finds faces between the edges.
    """
    import meshkernel

    used, of_edges = np.unique(edges, return_inverse=True)
    x, y = _columns(points[used])
    given = meshkernel.Mesh2d(x, y, of_edges.ravel())
    given.face_nodes = np.searchsorted(used, faces[faces >= 0]).astype(np.int32)
    given.nodes_per_face = np.count_nonzero(faces >= 0, axis=1).astype(np.int32)
    projections = {"plane": meshkernel.ProjectionType.CARTESIAN, "sphere": meshkernel.ProjectionType.SPHERICAL}
    kernel = meshkernel.MeshKernel(projections[surface])
    kernel.mesh2d_set(given)
    found = kernel.mesh2d_get()
    if len(found.node_x) != len(used):
        raise MeshError(
            f"mesh: MeshKernel keeps {len(found.node_x)} of {len(used)} nodes. Pass a mesh that mesh2d_get returns"
        )
    rows = _rows(used[found.face_nodes], found.nodes_per_face.astype(np.int64))
    return rows, np.column_stack([found.face_x, found.face_y])


def _centers(faces: Integers, points: Any, surface: str) -> Any:
    """Return the centers of faces that MeshKernel computes, of shape (m, 2); means of nodes for faces that it drops."""
    sizes = np.count_nonzero(faces >= 0, axis=1)
    next_column = (np.arange(faces.shape[1]) + 1) % sizes[:, None]
    sides = np.stack([faces, np.take_along_axis(faces, next_column, axis=1)], axis=-1)[faces >= 0]
    found, centers = _of_kernel(np.unique(np.sort(sides, axis=1), axis=0), faces, points, surface)
    # MeshKernel has put the faces in another order, and may start them at other nodes.
    width = max(faces.shape[1], found.shape[1])
    padded = [np.pad(own, ((0, 0), (0, width - own.shape[1])), constant_values=-1) for own in (found, faces)]
    number = np.unique(np.sort(np.concatenate(padded), axis=1), axis=0, return_inverse=True)[1].ravel()
    place = np.full(len(number), -1)
    place[number[: len(found)]] = np.arange(len(found))
    index = place[number[len(found) :]]
    means = np.where((faces >= 0)[..., None], points[faces], 0.0).sum(axis=1) / sizes[:, None]
    return np.where((index >= 0)[:, None], centers[index], means)
