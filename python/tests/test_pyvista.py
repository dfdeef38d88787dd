"""Meshes of PyVista in place of arrays, and the accessor."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import Points, Triangles, lattice, mixed

import gpu_smooth

pytestmark = pytest.mark.heavy
Mesh = tuple[Points, Triangles]


def grid_of(points: Points, cells: list[tuple[int, Any]]) -> Any:
    import pyvista

    connectivity = [row for _, rows in cells for row in np.asarray(rows)]
    types = [kind for kind, rows in cells for _ in rows]
    padded = np.concatenate([[len(row), *row] for row in connectivity])
    return pyvista.UnstructuredGrid(padded, types, np.column_stack([points, np.zeros(len(points))]))


def test_grids_and_surfaces_are_smoothed_as_their_arrays(mesh: Mesh) -> None:
    import pyvista

    points, triangles = mesh
    smoothed = gpu_smooth.smooth(points, triangles)
    grid = grid_of(points, [(5, triangles)])
    grid["depth"] = np.arange(float(len(points)))
    surface = pyvista.PolyData.from_regular_faces(np.column_stack([points, 0 * points[:, 0]]), triangles)
    for given in (grid, surface):
        before = np.array(given.points)
        result = gpu_smooth.smooth(given)
        assert type(result) is type(given)
        assert np.array_equal(np.asarray(result.points)[:, :2].astype(smoothed.dtype), smoothed)
        assert np.array_equal(given.points, before), "the given mesh is not changed"
    assert np.array_equal(gpu_smooth.smooth(grid)["depth"], grid["depth"])


def test_vertices_of_other_cells_and_between_regions_stay(mesh: Mesh) -> None:
    import pyvista

    points, triangles = mesh
    cut = np.isin(np.arange(len(triangles)) % 144, [30, 31])
    quad = [33, 34, 47, 46]
    left, right = triangles[~cut & (triangles[:, 0] // 13 < 8)], triangles[~cut & (triangles[:, 0] // 13 >= 8)]
    line = [45, 58, 71, 84]
    grid = grid_of(points, [(5, left), (9, [quad]), (4, [line]), (5, right), (1, [[97]])])
    grid.cell_data["material"] = np.repeat([1, 5, 5, 2, 5], [len(left), 1, 1, len(right), 1])
    stays = [*quad, *line, 97, *range(8 * 13, 9 * 13)]
    moved = (np.asarray(gpu_smooth.smooth(grid).points) != np.asarray(grid.points)).any(axis=1)
    assert not moved[stays].any() and moved.sum() > 50
    faces = np.concatenate([*([3, *t] for t in left), [4, *quad], *([3, *t] for t in right)])
    surface = pyvista.PolyData(
        np.column_stack([points, 0 * points[:, 0]]), faces=faces, lines=[4, *line], verts=[1, 97]
    )
    surface.cell_data["material"] = np.repeat([5, 5, 1, 5, 2], [1, 1, len(left), 1, len(right)])
    of_surface = np.asarray(gpu_smooth.smooth(surface).points)
    assert np.array_equal(of_surface, np.asarray(gpu_smooth.smooth(grid).points))
    slid = gpu_smooth.smooth(grid, slide=True)
    assert (np.asarray(slid.points)[line[1:-1]] != np.asarray(grid.points)[line[1:-1]]).any()


def test_quadrilaterals_move_unless_told(mesh: Mesh) -> None:
    import pyvista

    points, _ = mesh
    triangles, quadrilaterals = mixed(12)
    grid = grid_of(points, [(9, quadrilaterals), (5, triangles)])
    expected = gpu_smooth.smooth(np.asarray(grid.points), triangles, quadrilaterals=quadrilaterals)
    faces = np.concatenate([*([4, *q] for q in quadrilaterals), *([3, *t] for t in triangles)])
    surface = pyvista.PolyData(np.column_stack([points, 0 * points[:, 0]]), faces=faces)
    for given in (grid, surface):
        assert np.array_equal(gpu_smooth.smooth(given).points, expected.astype(given.points.dtype))
        kept = gpu_smooth.smooth(given, quadrilaterals="keep").points
        moved = (np.asarray(kept) != np.asarray(given.points)).any(axis=1)
        assert not moved[quadrilaterals].any() and moved.sum() > 40
    values = grid.gpu_smooth.quality("shape")
    assert np.array_equal(values, gpu_smooth.quality(grid.points, triangles, "shape", quadrilaterals=quadrilaterals))
    grid.cell_data["material"] = np.repeat([4, 6], [len(quadrilaterals), len(triangles)])
    moved = (np.asarray(gpu_smooth.smooth(grid).points) != np.asarray(grid.points)).any(axis=1)
    assert not moved[np.arange(169) % 13 == 6].any() and moved.sum() > 80


def test_the_accessor_is_found_by_its_entry_point(mesh: Mesh) -> None:
    points, triangles = mesh
    grid = grid_of(points, [(5, triangles)])
    smoothed = grid.gpu_smooth.smooth(scheme="rms")
    assert np.array_equal(smoothed.points, gpu_smooth.smooth(grid, scheme="rms").points)
    values = smoothed.gpu_smooth.quality("min-angle")
    assert np.array_equal(values, gpu_smooth.quality(smoothed.points, triangles, "min-angle"))


def test_other_datasets_are_refused() -> None:
    import pyvista

    with pytest.raises(gpu_smooth.MeshError, match="ImageData is not accepted"):
        gpu_smooth.smooth(pyvista.ImageData(dimensions=(3, 3, 1)))
    points, _ = lattice(1)
    with pytest.raises(gpu_smooth.MeshError, match="no triangles"):
        gpu_smooth.smooth(grid_of(points, [(8, [[0, 1, 2, 3]])]))
