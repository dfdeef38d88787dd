"""Meshes of MeshKernel in place of arrays, and measures that MeshKernel has too."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import Points, Triangles, lattice

import gpu_smooth

pytestmark = pytest.mark.heavy
Mesh = tuple[Points, Triangles]


def edges_of(triangles: Triangles) -> Triangles:
    return np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)


def of_edges(points: Points, edges: Any) -> Any:
    """Return a mesh of edges alone."""
    import meshkernel

    x, y = np.ascontiguousarray(points.T)
    return meshkernel.Mesh2d(x, y, np.asarray(edges, np.int32).ravel())


def administered(mesh: Any, projection: str = "CARTESIAN") -> tuple[Any, Any]:
    """Return a MeshKernel with a mesh, and the mesh as MeshKernel returns it: with faces, centers and middles."""
    import meshkernel

    kernel = meshkernel.MeshKernel(meshkernel.ProjectionType[projection])
    kernel.mesh2d_set(mesh)
    return kernel, kernel.mesh2d_get()


def points_of(mesh: Any) -> Points:
    return np.column_stack([mesh.node_x, mesh.node_y])


def test_a_mesh_is_smoothed_as_its_arrays_in_every_function(mesh: Mesh) -> None:
    import meshkernel

    points, triangles = mesh
    given = administered(of_edges(points, edges_of(triangles)))[1]
    own = given.face_nodes.reshape(-1, 3)
    expected = gpu_smooth.smooth(points, own, scheme="acute")
    smoothed = gpu_smooth.smooth(given, scheme="acute")
    assert type(smoothed) is meshkernel.Mesh2d
    assert np.array_equal(points_of(smoothed), expected) and not np.array_equal(expected, points)
    assert np.array_equal(points_of(given), points), "the given mesh is not changed"
    assert np.array_equal(points_of(gpu_smooth.run(given, scheme="acute").mesh), expected)
    assert np.array_equal(points_of(gpu_smooth.Smoother(given).run(scheme="acute").mesh), expected)
    values = gpu_smooth.quality(given, measure="orthogonality")
    assert np.array_equal(values, gpu_smooth.quality(points, own, "orthogonality"))


@pytest.mark.parametrize("surface", ["plane", "sphere"])
def test_centers_and_middles_are_those_of_meshkernel_at_the_new_nodes(mesh: Mesh, surface: Any) -> None:
    points, triangles = mesh
    points = points * 0.1 + [4.0, 52.0]
    projection = "SPHERICAL" if surface == "sphere" else "CARTESIAN"
    given = administered(of_edges(points, edges_of(triangles)), projection)[1]
    smoothed = gpu_smooth.smooth(given, surface=surface)
    expected = administered(of_edges(points_of(smoothed), edges_of(triangles)), projection)[1]
    names = ("face_x", "face_y", "edge_x", "edge_y")
    for name in names:
        assert not np.allclose(getattr(given, name), getattr(expected, name), rtol=0, atol=1e-4), name
        np.testing.assert_allclose(getattr(smoothed, name), getattr(expected, name), rtol=0, atol=1e-12, err_msg=name)
    # MeshKernel returns faces in its own order.
    given.face_nodes = np.roll(given.face_nodes.reshape(-1, 3)[::-1], 1, axis=1).ravel()
    backward = gpu_smooth.smooth(given, surface=surface, method="paper", max_sweeps=1)
    expected = administered(of_edges(points_of(backward), edges_of(triangles)), projection)[1]
    np.testing.assert_allclose(backward.face_x, expected.face_x[::-1], rtol=0, atol=1e-12)
    # Without them, there are none afterwards.
    given.face_x = given.face_y = given.edge_x = given.edge_y = np.empty(0)
    bare = gpu_smooth.smooth(given, surface=surface)
    assert all(getattr(bare, name).size == 0 for name in names)


def test_faces_of_edges_alone_are_found(mesh: Mesh) -> None:
    points, triangles = mesh
    edges = edges_of(triangles)
    expected = gpu_smooth.smooth(points, administered(of_edges(points, edges))[1].face_nodes.reshape(-1, 3))
    # A node without edges, and a chain of edges with a loose end, come first.
    points = np.concatenate([[[-1.0, -1.0], [-2.0, 1.0], [-1.0, 2.0]], points])
    given = of_edges(points, np.concatenate([[[1, 2], [2, 3]], edges + 3]))
    smoothed = gpu_smooth.smooth(given)
    assert np.array_equal(points_of(smoothed)[3:], expected) and np.array_equal(points_of(smoothed)[:3], points[:3])
    assert smoothed.face_nodes.size == 0 and np.array_equal(smoothed.edge_nodes, given.edge_nodes)
    for none in ([], [[0, 1]]):
        with pytest.raises(gpu_smooth.MeshError, match="no triangles"):
            gpu_smooth.smooth(of_edges(points, np.reshape(none, (-1, 2))))


def test_nodes_of_faces_with_four_nodes_stay(mesh: Mesh) -> None:
    points, triangles = mesh
    edges = edges_of(triangles)
    quads = np.array([[33, 34, 47, 46], [34, 35, 48, 47]])
    is_diagonal = np.isin(edges[:, 0], quads[:, 0]) & (edges[:, 1] == edges[:, 0] + 14)
    given = administered(of_edges(points, edges[~is_diagonal]))[1]
    assert sorted(set(given.nodes_per_face)) == [3, 4]
    smoothed = gpu_smooth.smooth(given)
    moved = (points_of(smoothed) != points).any(axis=1)
    assert not moved[quads].any() and moved.sum() > 100
    expected = administered(of_edges(points_of(smoothed), edges[~is_diagonal]))[1]
    np.testing.assert_allclose(smoothed.face_y, expected.face_y, rtol=0, atol=1e-12)
    assert len(gpu_smooth.quality(given)) == np.count_nonzero(given.nodes_per_face == 3)


def test_numbers_of_no_node_are_refused(mesh: Mesh) -> None:
    points, triangles = mesh
    given = administered(of_edges(points, edges_of(triangles)))[1]
    given.face_nodes[7] = 999
    with pytest.raises(gpu_smooth.MeshError, match=r"face_nodes\[7\] is 999, but the mesh has 169 nodes"):
        gpu_smooth.smooth(given)
    with pytest.raises(gpu_smooth.MeshError, match=r"edge_nodes\[1\] is -2"):
        gpu_smooth.smooth(of_edges(points, [[0, -2]]))
    given.face_nodes[7] = 0
    given.nodes_per_face = given.nodes_per_face[1:]
    with pytest.raises(gpu_smooth.MeshError, match="add up to the 864 numbers in face_nodes. Their sum is 861"):
        gpu_smooth.quality(given)


@pytest.mark.parametrize("seed", [1, 2, 3, 4, 5, "degrees"])
def test_measures_of_edges_are_those_of_meshkernel(seed: Any) -> None:
    import meshkernel

    in_degrees = seed == "degrees"
    points, triangles = lattice(12, 6 if in_degrees else seed, 0.3)
    surface: Any = "sphere" if in_degrees else "plane"
    points = points * [0.02, 0.01] + [4.0, 60.0] if in_degrees else points * seed
    kernel, given = administered(of_edges(points, edges_of(triangles)), "SPHERICAL" if in_degrees else "CARTESIAN")
    own = given.face_nodes.reshape(-1, 3)
    edges = {tuple(sorted(edge)): k for k, edge in enumerate(given.edge_nodes.reshape(-1, 2).tolist())}
    sides = np.array([[edges[tuple(sorted((row[k], row[k - 1])))] for k in range(3)] for row in own.tolist()])
    # MeshKernel has -999 at edges of the boundary.
    cosines = np.abs(kernel.mesh2d_get_orthogonality().values)
    ratios = kernel.mesh2d_get_smoothness().values
    found = {name: gpu_smooth.quality(given, measure=name, surface=surface) for name in ("orthogonality", "size-ratio", "flow-link")}
    np.testing.assert_allclose(found["orthogonality"], np.where(cosines == 999, 0, cosines)[sides].max(axis=1), rtol=0, atol=1e-9)
    if in_degrees:
        return
    np.testing.assert_allclose(found["size-ratio"], np.maximum(ratios, 1)[sides].max(axis=1), rtol=1e-9)
    # MeshKernel returns no lengths of links, so the links are those between its circumcenters.
    (a, b), (c, d) = (np.moveaxis(points[own][:, 1:] - points[own][:, :1], 1, 0)[k].T for k in (0, 1))
    roots = np.sqrt(np.abs(a * d - b * c) / 2)
    of_faces = meshkernel.Mesh2dLocation.FACES
    circumcenters = kernel.mesh2d_get_property(of_faces, meshkernel.Mesh2d.Property.FACE_CIRCUMCENTER)
    centers = np.column_stack([circumcenters.x_coordinates, circumcenters.y_coordinates])
    least = np.full(len(own), np.inf)
    for edge in np.unique(sides):
        across = np.flatnonzero((sides == edge).any(axis=1))
        if len(across) == 2:
            link = np.linalg.norm(centers[across[0]] - centers[across[1]]) / roots[across].mean()
            least[across] = np.minimum(least[across], link)
    np.testing.assert_allclose(found["flow-link"], least, rtol=0, atol=1e-9)
