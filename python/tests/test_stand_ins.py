"""Meshes of MeshKernel and xugrid in place of arrays, without these packages."""

from __future__ import annotations

import re
import sys
from typing import Any

import numpy as np
import pytest
import stand_ins
from conftest import Points, Triangles, across_date_line
from stand_ins import DataArray, Dataset, Mesh2d, Ugrid2d, UgridDataArray, UgridDataset

import gpu_smooth

Mesh = tuple[Points, Triangles]


@pytest.fixture(autouse=True)
def packages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "meshkernel", stand_ins.meshkernel)
    monkeypatch.setitem(sys.modules, "xugrid", stand_ins.xugrid)


def mesh2d(points: Points, faces: Any) -> Mesh2d:
    """Return a mesh with faces of equally many nodes, and with the middles of its edges."""
    faces = np.asarray(faces)
    edges = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    edges = np.unique(np.sort(edges, axis=1), axis=0).astype(np.int32)
    x, y = points.T
    made = Mesh2d(x, y, edges.ravel(), faces.ravel().astype(np.int32), np.full(len(faces), faces.shape[1], np.int32))
    made.edge_x, made.edge_y = points[edges].mean(axis=1).T
    return made


def points_of(mesh: Any) -> Points:
    return np.column_stack([mesh.node_x, mesh.node_y])


def test_a_mesh_of_meshkernel_is_smoothed_as_its_arrays(mesh: Mesh) -> None:
    points, triangles = mesh
    given = mesh2d(points, triangles)
    smoothed = gpu_smooth.smooth(given, scheme="acute")
    assert type(smoothed) is Mesh2d
    expected = gpu_smooth.smooth(points, triangles, scheme="acute")
    assert np.array_equal(points_of(smoothed), expected) and not np.array_equal(expected, points)
    assert np.array_equal(points_of(given), points), "the given mesh is not changed"
    assert smoothed.node_x.flags.c_contiguous and smoothed.face_nodes is given.face_nodes
    ends = given.edge_nodes.reshape(-1, 2)
    np.testing.assert_allclose(smoothed.edge_x, expected[ends, 0].mean(axis=1), atol=1e-12)
    np.testing.assert_allclose(smoothed.edge_y, expected[ends, 1].mean(axis=1), atol=1e-12)
    assert smoothed.face_x.size == 0
    values = gpu_smooth.quality(given, measure="flow-link")
    assert np.array_equal(values, gpu_smooth.quality(points, triangles, "flow-link"))


def test_centers_of_meshkernel_come_to_the_faces_that_have_them(mesh: Mesh) -> None:
    points, triangles = mesh
    given = mesh2d(points, triangles)
    given.face_x = given.face_y = np.zeros(len(triangles))
    smoothed = gpu_smooth.smooth(given)
    means = points_of(smoothed)[triangles].mean(axis=1)
    # The stand-in drops the first face, whose center is then the mean of its nodes.
    offset = np.where(np.arange(len(triangles)) > 0, 1, 0)[:, None] * [100, 200]
    np.testing.assert_allclose(np.column_stack([smoothed.face_x, smoothed.face_y]), means + offset, atol=1e-12)


def test_nodes_of_quadrilaterals_of_meshkernel_stay_if_told(mesh: Mesh) -> None:
    points, triangles = mesh
    quad = np.array([33, 34, 47, 46])
    given = mesh2d(points, triangles[~np.isin(triangles, quad).sum(axis=1).astype(bool)])
    given.face_nodes = np.concatenate([quad, given.face_nodes])
    given.nodes_per_face = np.concatenate([[4], given.nodes_per_face])
    moved = (points_of(gpu_smooth.smooth(given, quadrilaterals="keep")) != points).any(axis=1)
    assert not moved[quad].any() and moved.sum() > 60


@pytest.mark.parametrize("name, index, value, message", [
    ("face_nodes", 7, 999, "mesh: face_nodes[7] is 999, but the mesh has 169 nodes: nodes are numbered from 0"),
    ("face_nodes", 0, -2, "mesh: face_nodes[0] is -2"),
    ("edge_nodes", 3, 169, "mesh: edge_nodes[3] is 169"),
    ("nodes_per_face", 5, 4, "add up to the 864 numbers in face_nodes. Their sum is 865, the least is 3"),
    ("nodes_per_face", 5, 2, "must be 3 or more"),
])
def test_damaged_meshes_of_meshkernel_are_refused(mesh: Mesh, name: str, index: int, value: int, message: str) -> None:
    given = mesh2d(*mesh)
    getattr(given, name)[index] = value
    with pytest.raises(gpu_smooth.MeshError, match=re.escape(message)):
        gpu_smooth.smooth(given)


def test_a_mesh_of_meshkernel_needs_triangles(mesh: Mesh) -> None:
    x, y = mesh[0].T
    for edges in [], [0, 1], [0, 1, 1, 2]:
        with pytest.raises(gpu_smooth.MeshError, match="there are no triangles"):
            gpu_smooth.smooth(Mesh2d(x, y, np.array(edges, np.int32)))


def grid_of(mesh: Mesh, is_geographic: bool = False) -> Ugrid2d:
    x, y = mesh[0].T
    return Ugrid2d(x, y, mesh[1], is_geographic)


def test_a_grid_of_xugrid_is_smoothed_as_its_arrays(mesh: Mesh) -> None:
    given = grid_of(mesh)
    old = given.centroids
    smoothed = gpu_smooth.smooth(given)
    assert type(smoothed) is Ugrid2d
    expected = gpu_smooth.smooth(*mesh)
    assert np.array_equal(smoothed.node_coordinates, expected) and not np.array_equal(expected, mesh[0])
    assert np.array_equal(given.node_coordinates, mesh[0]) and given.centroids is old, "the given grid is not changed"
    np.testing.assert_allclose(smoothed.centroids, expected[mesh[1]].mean(axis=1))
    assert smoothed._dataset is None and smoothed.face_node_connectivity is given.face_node_connectivity


@pytest.mark.filterwarnings("ignore:points. the mesh is adapted:gpu_smooth.MeshWarning")
def test_a_geographic_grid_of_xugrid_is_smoothed_on_the_sphere(mesh: Mesh) -> None:
    mesh = mesh[0] * [0.2, 0.1] + [4.0, 60.0], mesh[1]
    smoothed = gpu_smooth.smooth(grid_of(mesh, is_geographic=True)).node_coordinates
    assert np.array_equal(smoothed, gpu_smooth.smooth(*mesh, surface="sphere"))
    assert not np.array_equal(smoothed, gpu_smooth.smooth(*mesh, surface="plane"))


def test_data_of_xugrid_follow_the_nodes(mesh: Mesh) -> None:
    points, triangles = mesh
    grid = grid_of(mesh)
    edges, nodes, faces = "mesh2d_nEdges", "mesh2d_nNodes", "mesh2d_nFaces"
    depths = np.stack([2 * points[:, 0] - points[:, 1], points[:, 1]])
    gap = np.full(len(points), 3.0)
    gap[0] = np.nan
    data = {
        "depth": DataArray(depths, "time", nodes), "level": DataArray(np.arange(len(triangles)), faces),
        "kind": DataArray(np.arange(len(points)), nodes), "gap": DataArray(gap, nodes),
    }
    coords = {
        "mesh2d_node_x": DataArray(points[:, 0], nodes), "mesh2d_face_y": DataArray(grid.circumcenters[:, 1], faces),
        "mesh2d_edge_x": DataArray(grid.edge_coordinates[:, 0].astype(np.float32), edges), "width": DataArray(points[:, 1], nodes),
    }
    smoothed = gpu_smooth.smooth(UgridDataset(Dataset(data, coords), [grid]))
    new, [moved] = gpu_smooth.smooth(points, triangles), smoothed.grids
    assert type(smoothed) is UgridDataset and np.array_equal(moved.node_coordinates, new)
    found = {**smoothed.obj.data_vars, **smoothed.obj.coords}
    np.testing.assert_allclose(found["depth"].values, [2 * new[:, 0] - new[:, 1], new[:, 1]], atol=1e-12)
    np.testing.assert_allclose(found["width"].values, new[:, 1], atol=1e-12)
    np.testing.assert_array_equal(found["gap"].values, gap)
    assert found["level"] is data["level"] and found["kind"] is data["kind"]
    assert np.array_equal(found["mesh2d_node_x"].values, new[:, 0])
    assert np.array_equal(found["mesh2d_face_y"].values, moved.circumcenters[:, 1])
    assert np.array_equal(found["mesh2d_edge_x"].values, moved.edge_coordinates[:, 0].astype(np.float32))
    depth = gpu_smooth.smooth(UgridDataArray(data["depth"], grid))
    assert type(depth) is UgridDataArray and np.array_equal(depth.obj.values, found["depth"].values)


@pytest.mark.filterwarnings("ignore:points. the mesh is adapted:gpu_smooth.MeshWarning")
def test_data_of_xugrid_are_interpolated_across_the_date_line(mesh: Mesh) -> None:
    continued, wrapped = across_date_line(mesh[0])
    depths = DataArray(continued[:, 0] - continued[:, 1], "mesh2d_nNodes")
    smoothed = gpu_smooth.smooth(UgridDataArray(depths, grid_of((wrapped, mesh[1]), is_geographic=True)))
    new = smoothed.grids[0].node_coordinates
    assert np.ptp(new[:, 0]) > 359 and not np.array_equal(new, wrapped)
    np.testing.assert_allclose(smoothed.obj.values, new[:, 0] % 360 - new[:, 1], atol=1e-10)


def test_data_of_nodes_on_a_tangled_grid_of_xugrid_are_refused_before_untangling(mesh: Mesh) -> None:
    points, triangles = mesh[0].copy(), mesh[1]
    points[80] += 2.5
    grid = grid_of((points, triangles))
    nodes, faces = DataArray(points[:, 1], "mesh2d_nNodes", name="depth"), DataArray(triangles[:, 0] / 2, "mesh2d_nFaces")
    functions: list[Any] = [gpu_smooth.smooth, gpu_smooth.run, gpu_smooth.Smoother]
    for function in functions:
        for own in UgridDataArray(nodes, grid), UgridDataset(Dataset({"depth": nodes, "level": faces}, {}), [grid]):
            with pytest.raises(gpu_smooth.MeshError, match=(
                r"data of nodes \(depth\) cannot be interpolated, as \d+ triangles are inverted or flat, the first is triangle "
                r"\d+\. Pass the grid alone"
            )) as refused:
                function(own, untangle=True)
            assert len(refused.value.triangles) > 2
    assert not np.array_equal(gpu_smooth.smooth(grid, untangle=True).node_coordinates, points)
    # Data of faces stay, and data of nodes are no obstacle if nothing is to be untangled.
    assert gpu_smooth.smooth(UgridDataArray(faces, grid), untangle=True).obj.values is faces.values
    gpu_smooth.smooth(UgridDataArray(nodes, grid_of(mesh)), untangle=True)


def test_unknown_centers_of_xugrid_are_kept_with_a_warning(mesh: Mesh) -> None:
    given = DataArray(mesh[0][:, 1], "mesh2d_nNodes", coords={"mesh2d_face_x": DataArray(np.zeros(len(mesh[1])), "mesh2d_nFaces")})
    with pytest.warns(gpu_smooth.MeshWarning, match="mesh2d_face_x is not updated"):
        smoothed = gpu_smooth.smooth(UgridDataArray(given, grid_of(mesh)))
    assert smoothed.obj.coords["mesh2d_face_x"] is given.coords["mesh2d_face_x"]


def test_data_on_no_grid_or_on_two_grids_of_xugrid_are_refused(mesh: Mesh) -> None:
    grid = grid_of(mesh)
    for grids in [], [grid, grid]:
        with pytest.raises(gpu_smooth.MeshError, match=f"the UgridDataset has {len(grids)}. Pass one grid of mesh.grids"):
            gpu_smooth.smooth(UgridDataset(Dataset({}, {}), grids))


@pytest.mark.heavy
@pytest.mark.filterwarnings("ignore:numba is not installed")
def test_the_stand_ins_have_attributes_of_the_packages(mesh: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    import meshkernel
    import xarray
    import xugrid

    points, triangles = mesh
    x, y = np.ascontiguousarray(points.T)
    data = DataArray(x, "x")
    real = xugrid.Ugrid2d(x, y, -1, triangles)
    for own, other in (
        (mesh2d(points, triangles), meshkernel.Mesh2d(x, y, triangles[:, :2].ravel().astype(np.int32))),
        (stand_ins.MeshKernel, meshkernel.MeshKernel), (stand_ins.PROJECTIONS, meshkernel.ProjectionType),
        (grid_of(mesh), real), (data, xarray.DataArray(x)), (Dataset({}, {}), xarray.Dataset()),
        (UgridDataset(Dataset({}, {}), []), xugrid.UgridDataset(grids=[real])),
        (UgridDataArray(data, real), xugrid.UgridDataArray(xarray.DataArray(x, dims=real.node_dimension), real)),
    ):
        names = {name for name in dir(own) if not name.startswith("__")} - {"_kept"}
        assert names and names <= set(dir(other)), (other, names - set(dir(other)))
