"""Meshes of MeshKernel in place of arrays, and measures that MeshKernel has too."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest
from conftest import MESHES, Points, Triangles

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


def test_nodes_of_faces_with_four_nodes_move_unless_told(mesh: Mesh) -> None:
    points, triangles = mesh
    edges = edges_of(triangles)
    quads = np.array([[33, 34, 47, 46], [34, 35, 48, 47]])
    is_diagonal = np.isin(edges[:, 0], quads[:, 0]) & (edges[:, 1] == edges[:, 0] + 14)
    given = administered(of_edges(points, edges[~is_diagonal]))[1]
    assert sorted(set(given.nodes_per_face)) == [3, 4]
    kept = gpu_smooth.smooth(given, quadrilaterals="keep")
    moved = (points_of(kept) != points).any(axis=1)
    assert not moved[quads].any() and moved.sum() > 100
    smoothed = gpu_smooth.smooth(given)
    assert (points_of(smoothed) != points).any(axis=1)[quads].all()
    expected = administered(of_edges(points_of(smoothed), edges[~is_diagonal]))[1]
    np.testing.assert_allclose(smoothed.face_y, expected.face_y, rtol=0, atol=1e-12)
    assert len(gpu_smooth.quality(given)) == len(given.nodes_per_face)


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


def inner_edges(faces: Triangles) -> tuple[Triangles, Triangles]:
    """Return the ends of each edge between two faces, of shape (k, 2), and the faces, of shape (k, 2, 3)."""
    sides = np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    order = np.lexsort(sides.T[::-1])
    first = np.flatnonzero((sides[order[1:]] == sides[order[:-1]]).all(axis=1))
    return sides[order[first]], faces[np.column_stack([order[first], order[first + 1]]) // 3]


def measured(points: Points, pairs: Triangles, measure: str, surface: Any) -> Any:
    """Return a measure of each edge, by a mesh in which each pair of faces is on its own."""
    corners = pairs.reshape(-1, 6)
    numbers = (corners[:, :, None] == corners[:, None]).argmax(axis=2) + 6 * np.arange(len(corners))[:, None]
    return gpu_smooth.quality(points[corners].reshape(-1, 2), numbers.reshape(-1, 3), measure, surface=surface)[::2]


def shortest_links(kernel: Any, links: Any) -> Any:
    """Return every `STORED_EACH`-th of MeshKernel's flow links, ascending, to 1e-11.

    Checks that the shortest of `links`, ascending, and every twentieth are within 1e-9 of MeshKernel's. MeshKernel returns no
    lengths of links, but the edges whose links are shorter than a threshold.
    """
    def count(thresholds: Any) -> Any:
        return np.array([len(kernel.mesh2d_get_small_flow_edge_centers(own).x_coordinates) for own in thresholds])

    ranks = np.unique([*range(100), *range(0, len(links), 20), len(links) - 1])
    assert (count(links[ranks] - 1e-9) <= ranks).all() and (count(links[ranks] + 1e-9) > ranks).all()
    ranks = np.arange(0, len(links), STORED_EACH)
    low, high = links[ranks] - 1e-9, links[ranks] + 1e-9
    for _ in range(8):
        middle = (low + high) / 2
        is_short = count(middle) <= ranks
        low, high = np.where(is_short, middle, low), np.where(is_short, high, middle)
    return high


# Every this many edges of a mesh, in the order of their flow links, is in the list of MeshKernel's numbers.
STORED_EACH = 100
STORED = MESHES.parent / "tests" / "measures" / "meshkernel.txt"
HEAD = """# Measures of edges by MeshKernel 8.3.0. `GPU_SMOOTH_GOLDEN=write python/tests/run --all test_meshkernel.py` writes the file.
# mesh of meshes/, corners of both triangles from 0, orthogonality, flow link, smoothness. mechanic is in degrees: x / 2 + 4, y / 2 + 52
"""


def test_measures_of_edges_are_those_of_meshkernel() -> None:
    rows = []
    for name in ("plate", "airplane", "duck", "fish", "hand", "mechanic"):
        file, surface = gpu_smooth.MeshFile(MESHES / f"{name}.node"), "sphere" if name == "mechanic" else "plane"
        points = file.points / 2 + [4.0, 52.0] if surface == "sphere" else file.points
        projection = "SPHERICAL" if surface == "sphere" else "CARTESIAN"
        kernel, given = administered(of_edges(points, edges_of(file.triangles)), projection)
        ends, pairs = inner_edges(given.face_nodes.reshape(-1, 3))
        assert len(ends) > 3500
        links = measured(points, pairs, "flow-link", surface)
        order = np.argsort(links)
        ends, pairs, links = ends[order], pairs[order], links[order]
        number = {tuple(sorted(edge)): k for k, edge in enumerate(given.edge_nodes.reshape(-1, 2).tolist())}
        index = np.array([number[tuple(edge)] for edge in ends.tolist()])
        cosines = np.abs(kernel.mesh2d_get_orthogonality().values)[index]
        ratios = np.asarray(kernel.mesh2d_get_smoothness().values)[index]
        np.testing.assert_allclose(measured(points, pairs, "orthogonality", surface), cosines, rtol=0, atol=1e-9)
        np.testing.assert_allclose(measured(points, pairs, "smoothness", surface), ratios, rtol=1e-9)
        if surface == "plane":
            # In degrees, `size-ratio` has other areas than MeshKernel.
            np.testing.assert_allclose(measured(points, pairs, "size-ratio", surface), ratios, rtol=1e-9)
        shortest = shortest_links(kernel, links)
        for k, link in enumerate(shortest.tolist()):
            at = k * STORED_EACH
            rows.append([name, *pairs[at].ravel().tolist(), float(cosines[at]), link, float(ratios[at])])
    if os.environ.get("GPU_SMOOTH_GOLDEN") == "write":
        STORED.write_text(HEAD + "".join(" ".join(map(str, row)) + "\n" for row in rows))
    stored = [line.split() for line in STORED.read_text().splitlines() if not line.startswith("#")]
    assert [row[:7] for row in stored] == [[str(word) for word in row[:7]] for row in rows]
    np.testing.assert_allclose(np.array([row[7:] for row in stored], float), [row[7:] for row in rows], rtol=0, atol=1e-10)
