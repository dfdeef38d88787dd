"""Meshes of meshio in place of arrays."""

from __future__ import annotations

from typing import Any

import meshio
import numpy as np
import pytest
from conftest import Points, Triangles, lattice

import gpu_smooth

Mesh = tuple[Points, Triangles]


def test_a_mesh_of_triangles_is_smoothed_as_its_arrays(mesh: Mesh) -> None:
    points, triangles = mesh
    in_space = np.column_stack([points, np.full(len(points), 3.0)])
    data = {"depth": np.arange(float(len(points)))}
    given = meshio.Mesh(
        in_space, [("triangle", triangles[:100]), ("triangle", triangles[100:])], point_data=data
    )
    smoothed = gpu_smooth.smooth(given, scheme="rms")
    assert isinstance(smoothed, meshio.Mesh)
    assert np.array_equal(smoothed.points, gpu_smooth.smooth(in_space, triangles, scheme="rms"))
    assert np.array_equal(given.points, in_space), "the given mesh is not changed"
    assert smoothed.point_data["depth"] is given.point_data["depth"]
    assert [block.type for block in smoothed.cells] == ["triangle", "triangle"]


@pytest.mark.filterwarnings("ignore:points. the mesh is:gpu_smooth.MeshWarning")
def test_layers_stay_above_groups_of_walls() -> None:
    points, triangles = lattice(12, by=0.0)
    points[:, 1] = 12.0 * (1.4 ** points[:, 1] - 1.0) / (1.4**12 - 1.0)
    bottom = np.flatnonzero(points[:, 1] == points[0, 1])
    given = meshio.Mesh(points, [("triangle", triangles)], point_sets={"wall": bottom})
    smoothed = gpu_smooth.smooth(given, keep_layers="rows=2,wall")
    expected = gpu_smooth.smooth(points, triangles, keep_layers=("rows=2", bottom))
    assert np.array_equal(smoothed.points, expected)
    with pytest.raises(gpu_smooth.MeshError, match="keep_layers: the mesh has no group 'inlet'"):
        gpu_smooth.smooth(given, keep_layers="rows=2,inlet")


def test_vertices_of_other_cells_and_between_regions_stay(mesh: Mesh) -> None:
    points, triangles = mesh
    column = np.flatnonzero(np.arange(len(points)) % 13 == 6)
    line = np.stack([column[:-1], column[1:]], axis=1)
    cut = np.isin(np.arange(len(triangles)) % 144, [30, 31])
    quad = np.array([[33, 34, 47, 46]])
    is_right = triangles[:, 0] // 13 >= 8
    cells: Any = [
        ("triangle", triangles[~cut]), ("quad", quad), ("line", line), ("vertex", np.array([[100]])),
    ]
    numbers: Any = {
        "gmsh:physical": [np.where(is_right, 2, 1)[~cut], np.array([9]), np.full(len(line), 7), np.array([8])]
    }
    given = meshio.Mesh(points, cells, cell_data=numbers, field_data={"right": np.array([2, 2])})
    smoothed = gpu_smooth.smooth(given)
    stays = np.zeros(len(points), bool)
    row = np.arange(8 * 13, 9 * 13)
    stays[[*column, *quad.ravel(), 100, *row]] = True
    moved = (smoothed.points != points).any(axis=1)
    assert not moved[stays].any() and moved.sum() > 50
    assert smoothed.field_data is given.field_data and len(smoothed.cells) == 4
    fixed = gpu_smooth.smooth(given, fixed=[17])
    assert np.array_equal(fixed.points[17], points[17]) and moved[17]
    with pytest.raises(gpu_smooth.MeshError, match=r"fixed\[0\] is 999"):
        gpu_smooth.smooth(given, fixed=[999])
    with pytest.raises(gpu_smooth.MeshError, match=r"lines: .* the shape is \(3,\)"):
        gpu_smooth.smooth(given, lines=[1, 2, 3])
    with pytest.raises(gpu_smooth.MeshError, match=r"lines\[\d+, 1\] is 999"):
        gpu_smooth.smooth(given, lines=[[1, 999]])
    assert np.array_equal(gpu_smooth.smooth(given, regions=None, lines=None).points, smoothed.points)


def test_groups_are_fixed_by_name(mesh: Mesh) -> None:
    points, triangles = mesh
    line = np.array([[30, 31], [31, 32]])
    cells: Any = [("triangle", triangles), ("line", line)]
    numbers: Any = {"gmsh:physical": [np.where(triangles[:, 0] // 13 >= 8, 4, 3), np.array([4, 4])]}
    given = meshio.Mesh(
        points, cells, cell_data=numbers, field_data={"top": np.array([4, 2]), "wall": np.array([4, 1])},
        point_sets={"gauges": np.array([40, 41])}, cell_sets={"first": [np.array([0, 50]), np.array([], int)]},
    )
    of_names: dict[str, Any] = {
        "top": triangles[triangles[:, 0] // 13 >= 8], "wall": line, "gauges": [40, 41], "first": triangles[[0, 50]],
    }
    for name, vertices in of_names.items():
        expected = gpu_smooth.smooth(given, fixed=np.unique(vertices)).points
        assert np.array_equal(gpu_smooth.smooth(given, fixed=name).points, expected), name
        assert np.array_equal(gpu_smooth.smooth(given, fixed=[name, name]).points, expected), name
    assert not np.array_equal(gpu_smooth.smooth(given, fixed="gauges").points, gpu_smooth.smooth(given).points)
    with pytest.raises(gpu_smooth.MeshError, match="no group 'bottom'. Its groups are: first, gauges, top, wall"):
        gpu_smooth.smooth(given, fixed=["top", "bottom"])
    with pytest.raises(gpu_smooth.MeshError, match="fixed: "):
        gpu_smooth.smooth(points, triangles, fixed="top")


def test_a_file_of_meshio_is_smoothed_as_by_the_command_line(tmp_path: Any) -> None:
    from conftest import command_line

    points, triangles = lattice(10)
    physical: Any = {"gmsh:physical": [(triangles[:, 0] % 11 > 5).astype(int)]}
    mesh = meshio.Mesh(points, [("triangle", triangles)], cell_data=physical)
    mesh.write(tmp_path / "in.vtu", binary=False)
    assert command_line(tmp_path / "in.vtu", tmp_path / "out.vtu").returncode == 0
    of_file = meshio.read(tmp_path / "out.vtu")
    smoothed = gpu_smooth.smooth(meshio.read(tmp_path / "in.vtu"))
    assert np.array_equal(smoothed.points[:, :2], of_file.points[:, :2])


def test_a_mesh_without_triangles_and_quadrilaterals_is_refused() -> None:
    cells: Any = [("polygon", np.array([[0, 1, 2, 3, 4]])), ("line", np.array([[0, 1]]))]
    with pytest.raises(gpu_smooth.MeshError, match="no triangles of three vertices, and no quadrilaterals"):
        gpu_smooth.smooth(meshio.Mesh(np.eye(5, 2), cells))


def test_constraints_of_the_mesh_hold_beside_empty_and_other_options(mesh: Mesh) -> None:
    points, triangles = mesh
    column = np.flatnonzero(np.arange(len(points)) % 13 == 6)
    line = np.stack([column[:-1], column[1:]], axis=1)
    given = meshio.Mesh(points, [("triangle", triangles), ("line", line)])
    expected = gpu_smooth.smooth(given).points
    options: list[Any] = [
        {"fixed": []}, {"lines": []}, {"fixed": np.array([])}, {"lines": np.array([[0, 1]], np.uint64)}, {"fixed": (0,)},
    ]
    for one in options:
        assert np.array_equal(gpu_smooth.smooth(given, **one).points, expected), one
    ragged: Any = [1, [2]]
    # The index is that of the argument, not of the lines of the mesh before.
    with pytest.raises(gpu_smooth.MeshError, match=r"lines\[0, 1\] is 999"):
        gpu_smooth.smooth(given, lines=[[1, 999]])
    with pytest.raises(gpu_smooth.MeshError, match="fixed: .* no array can be made"):
        gpu_smooth.smooth(given, fixed=ragged)
    of_type = meshio.Mesh(points, given.cells, point_sets={"wall": np.array([30])})
    named = gpu_smooth.smooth(of_type, fixed=np.array(["wall"])).points
    assert np.array_equal(named[30], points[30]) and not np.array_equal(expected[30], points[30])


def test_wrong_cells_are_refused(mesh: Mesh) -> None:
    points, triangles = mesh
    for vertex in (-5, 999):
        given = meshio.Mesh(points, [("triangle", triangles), ("vertex", np.array([[vertex]]))])
        with pytest.raises(gpu_smooth.MeshError, match=f"a cell has the vertex {vertex}, but the mesh has 169 points"):
            gpu_smooth.smooth(given)
    with pytest.raises(gpu_smooth.MeshError, match="type triangle are numbers of type float64"):
        gpu_smooth.smooth(meshio.Mesh(points, [("triangle", triangles + 0.5)]))


def test_regions_may_be_flags_names_and_columns(mesh: Mesh) -> None:
    points, triangles = mesh
    is_right = triangles[:, 0] // 13 >= 8
    expected = gpu_smooth.smooth(points, triangles, regions=is_right.astype(int))
    assert not np.array_equal(expected, gpu_smooth.smooth(points, triangles))
    numbers: list[Any] = [
        is_right, np.where(is_right, "steel", "rock"), np.where(is_right, 1.0, 1e300), is_right[:, None].astype(int),
        np.where(is_right, 2**63 + 1, 2**63).astype(np.uint64),
    ]
    for one in numbers:
        given = meshio.Mesh(points, [("triangle", triangles)], cell_data={"material": [one]})
        assert np.array_equal(gpu_smooth.smooth(given).points, expected), one[:2]
