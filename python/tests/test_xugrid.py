"""Meshes of xugrid in place of arrays."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import Points, Triangles, across_date_line

import gpu_smooth

# Without numba, xugrid warns that it is slow.
pytestmark = [pytest.mark.heavy, pytest.mark.filterwarnings("ignore:numba is not installed")]
Mesh = tuple[Points, Triangles]


def grid_of(points: Any, faces: Any, is_projected: bool = True) -> Any:
    import xugrid

    return xugrid.Ugrid2d(*points.T, -1, np.asarray(faces), is_projected=is_projected)


def test_a_grid_is_smoothed_as_its_arrays(mesh: Mesh) -> None:
    points, triangles = mesh
    given = grid_of(points, triangles)
    given.circumcenters
    smoothed = gpu_smooth.smooth(given)
    assert type(smoothed) is type(given)
    expected = gpu_smooth.smooth(points, triangles)
    assert np.array_equal(smoothed.node_coordinates, expected)
    assert np.array_equal(given.node_coordinates, points), "the given grid is not changed"
    assert np.array_equal(smoothed.circumcenters, grid_of(expected, triangles).circumcenters)
    assert np.array_equal(gpu_smooth.run(given).mesh.node_coordinates, expected)
    assert np.array_equal(gpu_smooth.quality(given), gpu_smooth.quality(points, triangles))


@pytest.mark.filterwarnings("ignore:points. the mesh is adapted:gpu_smooth.MeshWarning")
def test_a_geographic_grid_is_smoothed_on_the_sphere(mesh: Mesh) -> None:
    points, triangles = mesh[0] * [0.2, 0.1] + [4.0, 60.0], mesh[1]
    given = grid_of(points, triangles, is_projected=False)
    smoothed = gpu_smooth.smooth(given)
    assert smoothed.is_geographic
    assert np.array_equal(smoothed.node_coordinates, gpu_smooth.smooth(points, triangles, surface="sphere"))
    in_plane = gpu_smooth.smooth(given, surface="plane").node_coordinates
    assert np.array_equal(in_plane, gpu_smooth.smooth(points, triangles, surface="plane"))
    assert not np.array_equal(in_plane, smoothed.node_coordinates)
    of_sphere = gpu_smooth.quality(points, triangles, surface="sphere")
    assert np.array_equal(gpu_smooth.quality(given), of_sphere)


def test_depths_are_interpolated_and_data_of_faces_stay(mesh: Mesh) -> None:
    import xugrid

    points, triangles = mesh
    data = grid_of(points, triangles).to_dataset()
    depths = np.stack([2.0 * points[:, 0] - points[:, 1], points[:, 1]])
    data["depth"] = (("time", "mesh2d_nNodes"), depths)
    data["level"] = ("mesh2d_nFaces", np.arange(float(len(triangles))))
    data = grid_of(points, triangles).assign_face_coords(data)
    given = xugrid.UgridDataset(data)
    smoothed = gpu_smooth.smooth(given)
    new = gpu_smooth.smooth(points, triangles)
    assert type(smoothed) is xugrid.UgridDataset and np.array_equal(smoothed.ugrid.grid.node_coordinates, new)
    written = smoothed.ugrid.to_dataset()
    np.testing.assert_allclose(written["depth"], [2.0 * new[:, 0] - new[:, 1], new[:, 1]], atol=1e-12)
    assert np.array_equal(written["level"], data["level"])
    assert np.array_equal(written["mesh2d_node_x"], new[:, 0])
    np.testing.assert_allclose(written["mesh2d_face_x"], new[triangles, 0].mean(axis=1), atol=1e-12)
    assert np.array_equal(given["depth"].values, depths), "the given data are not changed"
    depth = gpu_smooth.smooth(given["depth"])
    assert type(depth) is xugrid.UgridDataArray
    np.testing.assert_allclose(depth.values[1], new[:, 1], atol=1e-12)


@pytest.mark.filterwarnings("ignore:points. the mesh is adapted:gpu_smooth.MeshWarning")
def test_depths_are_interpolated_across_the_date_line(mesh: Mesh) -> None:
    import xugrid

    continued, wrapped = across_date_line(mesh[0])
    data = grid_of(wrapped, mesh[1], is_projected=False).to_dataset()
    data["depth"] = ("mesh2d_nNodes", continued[:, 0] - continued[:, 1])
    given = xugrid.UgridDataset(data)
    assert given.ugrid.grid.is_geographic
    smoothed = gpu_smooth.smooth(given)
    new = smoothed.ugrid.grid.node_coordinates
    assert np.ptp(new[:, 0]) > 359 and not np.array_equal(new, wrapped)
    np.testing.assert_allclose(smoothed["depth"], new[:, 0] % 360 - new[:, 1], atol=1e-10)


def test_depths_on_a_tangled_grid_are_refused_before_untangling(mesh: Mesh) -> None:
    import xugrid

    points = mesh[0].copy()
    points[80] += 2.5
    data = grid_of(points, mesh[1]).to_dataset()
    data["depth"] = ("mesh2d_nNodes", points[:, 0])
    given = xugrid.UgridDataset(data)
    with pytest.raises(gpu_smooth.MeshError, match=r"data of nodes \(depth\) cannot be interpolated.*Pass the grid alone"):
        gpu_smooth.smooth(given, untangle=True)
    untangled = gpu_smooth.smooth(given.ugrid.grid, untangle=True).node_coordinates
    assert (gpu_smooth.quality(untangled, mesh[1], "min-angle") > 1).all()
