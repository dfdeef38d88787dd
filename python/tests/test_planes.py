"""Points with third coordinates: in planes of any orientation, on curved surfaces, and with z as data."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from conftest import Points, Triangles, command_line, written

import gpu_smooth
from gpu_smooth import MeshError, OptionError

Mesh = tuple[Points, Triangles]
Space = npt.NDArray[Any]


def xz(points: Space) -> Space:
    return np.insert(points, 1, 5.5, axis=1)


def yz(points: Space) -> Space:
    return np.insert(points, 0, 5.5, axis=1)


def tilted(points: Space) -> Space:
    x, y = points.T
    return np.stack([x - 0.3 * y + 100, 0.2 * x + y, 0.75 * x + 2 * y - 7], axis=1)


def domed(points: Space) -> Space:
    return np.column_stack([points, 0.1 * np.hypot(*(points - 6).T)])


# The tilted mesh is stretched 4-fold.
pytestmark = pytest.mark.filterwarnings("ignore:points. the mesh is:gpu_smooth.MeshWarning")
PLANES = {"xz": xz, "yz": yz, "tilted": tilted}


def of_file(path: Path) -> Space:
    file = gpu_smooth.MeshFile(path)
    return np.column_stack([file.points, file.data("z")])


@pytest.mark.parametrize("kind", ["float64", "float32"])
@pytest.mark.parametrize("name", PLANES)
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({}, []),
        ({"engine": "gpu"}, ["--engine", "gpu"]),
        ({"slide": True, "corner_angle": 20}, ["--slide", "--corner-angle", "20"]),
        ({"target": "keep-size"}, ["--target", "keep-size"]),
        ({"max_move": 0.1, "improve_worst": True}, ["--max-move", "0.1", "--improve-worst"]),
        ({"untangle": True}, ["--untangle"]),
    ],
)
def test_a_mesh_in_another_plane_has_the_bits_of_the_command_line(
    options: dict[str, Any], words: list[str], name: str, kind: str, mesh: Mesh, tmp_path: Path
) -> None:
    points, triangles = mesh
    # The boundary is uneven, so that vertices have somewhere to slide to.
    points[:, 0] += 0.2 * np.sin(points[:, 0]) * (points[:, 0] % 12 > 0)
    if "untangle" in options:
        points[40] += [2.5, 2.5]
    space = PLANES[name](points).astype(kind)
    source, destination = written(tmp_path / "in.vtk", space, triangles), tmp_path / "out.vtk"
    done = command_line(source, destination, *words)
    assert done.returncode == 0, done.stderr
    result = gpu_smooth.run(space, triangles, **options)
    assert result.points.dtype == kind and result.points.shape == space.shape
    assert np.array_equal(result.points, of_file(destination).astype(kind))
    assert (result.points != space).any(axis=1).sum() > 50
    assert np.array_equal(result.points_before, space)
    assert np.array_equal(gpu_smooth.smooth(space, triangles, **options), result.points)


def test_a_mesh_in_the_plane_of_two_axes_is_smoothed_as_in_x_and_y(mesh: Mesh) -> None:
    points, triangles = mesh
    flat = gpu_smooth.run(points, triangles)
    assert flat.axes == ("x", "y")
    for place, axes in ((xz, ("x", "z")), (yz, ("y", "z"))):
        result = gpu_smooth.run(place(points), triangles)
        assert np.array_equal(result.points, place(flat.points))
        assert result.axes == axes
        assert result.quality_after.f() == flat.quality_after.f()
    level = np.insert(points, 2, 5.5, axis=1)
    assert np.array_equal(gpu_smooth.smooth(level, triangles), np.insert(flat.points, 2, 5.5, axis=1))
    steep = gpu_smooth.run(tilted(points), triangles)
    assert steep.axes == ("u", "v") and np.ptp(steep.displacement @ np.cross([1, 0.2, 0.75], [-0.3, 1, 2])) < 1e-9
    assert abs(gpu_smooth.run(tilted(points) @ np.eye(3)[[2, 0, 1]], triangles).quality_after.f() - steep.quality_after.f()) < 1e-6


def test_a_curved_surface_is_refused_unless_z_is_data(mesh: Mesh, tmp_path: Path) -> None:
    points, triangles = mesh
    space = domed(points)
    source, destination = written(tmp_path / "in.vtk", space, triangles), tmp_path / "out.vtk"
    done = command_line(source, destination)
    assert done.returncode == 3 and "is not planar" in done.stderr, done.stderr
    with pytest.raises(MeshError, match=r"^points\[\d+\]: the mesh is not planar.*pass z=\"data\"") as refused:
        gpu_smooth.smooth(space, triangles)
    assert f"vertex {refused.value.vertex} " in done.stderr
    with pytest.raises(MeshError, match="is not planar"):
        gpu_smooth.quality(space, triangles)
    with pytest.raises(MeshError, match=r"^before\[\d+\]: the mesh is not planar"):
        gpu_smooth.compare(space, space, triangles)
    done = command_line(source, destination, "--z", "data")
    assert done.returncode == 0, done.stderr
    smoothed = gpu_smooth.smooth(space, triangles, z="data")
    assert np.array_equal(smoothed, of_file(destination))
    assert np.array_equal(smoothed, np.column_stack([gpu_smooth.smooth(points, triangles), space[:, 2]]))
    on_sphere = gpu_smooth.smooth(space, triangles, surface="sphere")
    assert np.array_equal(on_sphere[:, 2], space[:, 2])
    with pytest.raises(OptionError, match='^z: the value is \'depth\', and must be "coordinate" or "data"'):
        gpu_smooth.smooth(space, triangles, z="depth")  # type: ignore[call-overload]


def test_third_coordinates_that_are_not_finite_are_refused_unless_z_is_data(mesh: Mesh) -> None:
    points, triangles = mesh
    for number in (np.nan, np.inf, -np.inf):
        space = xz(points)
        space[17, 2] = number
        with pytest.raises(MeshError, match=r"points\[17, 2\]: the third coordinate is") as refused:
            gpu_smooth.smooth(space, triangles)
        assert refused.value.vertex == 17
        depths = np.column_stack([points, np.full(len(points), number)])
        depths[3, 2] = 1
        assert np.array_equal(gpu_smooth.smooth(depths, triangles, z="data")[:, 2], depths[:, 2], equal_nan=True)


def test_functions_on_arrays_work_in_the_plane_of_the_mesh(mesh: Mesh) -> None:
    points, triangles = mesh
    flat = gpu_smooth.smooth(points, triangles)
    values = np.stack([points[:, 0], points[:, 1] ** 2], axis=1)
    tangled = points.copy()
    tangled[40] += [2.5, 2.5]
    for place in (xz, yz):
        space, moved = place(points), place(flat)
        assert np.array_equal(gpu_smooth.quality(space, triangles, "min-angle"), gpu_smooth.quality(points, triangles, "min-angle"))
        assert np.array_equal(
            gpu_smooth.interpolate(space, triangles, moved, values), gpu_smooth.interpolate(points, triangles, flat, values)
        )
        assert np.array_equal(gpu_smooth.untangle(place(tangled), triangles), place(gpu_smooth.untangle(tangled, triangles)))
        found, expected = gpu_smooth.compare(space, moved, triangles), gpu_smooth.compare(points, flat, triangles)
        assert found[:5] == expected[:5] and not found.z_changed
        moved[3, [5.5 == x for x in space[3]].index(True)] += 0.5
        assert gpu_smooth.compare(space, moved, triangles).z_changed
        with pytest.raises(MeshError, match=r"after: .* shape \(n, 3\) are needed"):
            gpu_smooth.compare(space, flat, triangles)
        # Sizes on another mesh belong to places of the same plane.
        corners = np.array([[0.0, 0], [12, 0], [12, 12], [0, 12]])
        on_corners = ([[0, 1, 2], [0, 2, 3]], 1.0 + corners[:, 0])
        by_sizes = gpu_smooth.smooth(space, triangles, target=(place(corners), *on_corners))
        assert np.array_equal(by_sizes, place(gpu_smooth.smooth(points, triangles, target=(corners, *on_corners))))
        with pytest.raises(MeshError, match=r"target\[0\]: .* shape \(n, 3\) are needed"):
            gpu_smooth.smooth(space, triangles, target=(corners, *on_corners))
    steep, before = tilted(points), gpu_smooth.quality(tilted(points), triangles)
    edges = np.diff(steep[triangles], axis=1)
    area = 0.5 * np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    lengths = np.sum([(steep[triangles[:, k]] - steep[triangles[:, k - 1]]) ** 2 for k in range(3)], axis=0)
    assert np.abs(lengths.sum(axis=1) / (4 * np.sqrt(3) * area) / before - 1).max() < 1e-9
    opened = gpu_smooth.untangle(tilted(tangled), triangles)
    assert np.isfinite(gpu_smooth.quality(opened, triangles)).all()


def test_a_prepared_mesh_of_another_plane_runs_many_times(mesh: Mesh) -> None:
    points, triangles = mesh
    smoother = gpu_smooth.Smoother(tilted(points), triangles)
    first, second = smoother.run(engine="cpu", max_sweeps=1), smoother.run(engine="cpu")
    assert first.quality_after.f() > second.quality_after.f() and first.axes == ("u", "v")
    assert np.array_equal(second.points, gpu_smooth.smooth(tilted(points), triangles, engine="cpu"))
    plain = gpu_smooth.run(points, triangles)
    assert gpu_smooth.run(xz(points), triangles)._repr_html_() == plain._repr_html_()


@pytest.mark.parametrize("place", [xz, tilted])
def test_a_file_is_written_with_third_coordinates(place: Any, mesh: Mesh, tmp_path: Path) -> None:
    points, triangles = mesh
    source = written(tmp_path / "in.vtk", place(points), triangles)
    file = gpu_smooth.MeshFile(source)
    space = np.column_stack([file.points, file.data("z")])
    file.write(tmp_path / "same.vtk", space)
    assert (tmp_path / "same.vtk").read_bytes() == source.read_bytes()
    file.write(tmp_path / "out.vtk", gpu_smooth.smooth(space, file.triangles))
    assert command_line(source, tmp_path / "expected.vtk").returncode == 0
    assert (tmp_path / "out.vtk").read_bytes() == (tmp_path / "expected.vtk").read_bytes()


def test_a_mesh_of_meshio_is_smoothed_in_its_plane(mesh: Mesh) -> None:
    import meshio

    points, triangles = mesh
    smoothed = gpu_smooth.smooth(meshio.Mesh(xz(points), [("triangle", triangles)]))
    assert np.array_equal(smoothed.points, xz(gpu_smooth.smooth(points, triangles)))
    depths = meshio.Mesh(domed(points), [("triangle", triangles)])
    with pytest.raises(MeshError, match="is not planar"):
        gpu_smooth.smooth(depths)
    assert np.array_equal(gpu_smooth.smooth(depths, z="data").points[:, 2], depths.points[:, 2])


@pytest.mark.heavy
def test_meshes_of_pyvista_are_smoothed_in_their_plane(mesh: Mesh) -> None:
    import pyvista

    points, triangles = mesh
    for kind in (np.float32, np.float64):
        space = tilted(points).astype(kind)
        surface = pyvista.PolyData.from_regular_faces(space, triangles)
        smoothed = surface.gpu_smooth.smooth()
        assert np.array_equal(np.asarray(smoothed.points), gpu_smooth.smooth(space, triangles))
        assert np.array_equal(surface.gpu_smooth.quality(), gpu_smooth.quality(space, triangles))
    depths = pyvista.PolyData.from_regular_faces(domed(points), triangles)
    with pytest.raises(MeshError, match="is not planar"):
        depths.gpu_smooth.smooth()
    assert np.array_equal(depths.gpu_smooth.smooth(z="data").points[:, 2], depths.points[:, 2])
    assert np.array_equal(
        depths.gpu_smooth.quality(z="data"), gpu_smooth.quality(np.asarray(depths.points)[:, :2], triangles)
    )


@pytest.mark.heavy
def test_pictures_of_another_plane_name_its_axes(mesh: Mesh) -> None:
    import matplotlib

    matplotlib.use("Agg")
    points, triangles = mesh
    result = gpu_smooth.run(xz(points), triangles)
    axes = result.plot().axes[0]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x", "z")
    (low, bottom), (high, top) = np.transpose([axes.get_xlim(), axes.get_ylim()])
    assert low <= 0 < 12 <= high and bottom <= 0 < 12 <= top


def test_data_named_z_stay_beside_third_coordinates(mesh: Mesh, tmp_path: Path) -> None:
    points, triangles = mesh
    data = np.arange(len(points), dtype=float)
    rows = "\n".join(" ".join(map(str, row)) for row in tilted(points).tolist())
    cells = "\n".join(f"3 {a} {b} {c}" for a, b, c in triangles.tolist())
    count, values = len(triangles), "\n".join(map(str, data.tolist()))
    path = tmp_path / "in.vtk"
    path.write_text(
        f"# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\n"
        f"POINTS {len(points)} double\n{rows}\nCELLS {count} {4 * count}\n{cells}\n"
        f"CELL_TYPES {count}\n" + "5\n" * count + f"POINT_DATA {len(points)}\n"
        f"SCALARS z double 1\nLOOKUP_TABLE default\n{values}\n"
    )
    file = gpu_smooth.MeshFile(path)
    np.testing.assert_array_equal(file.data("z"), tilted(points)[:, 2])
    result = gpu_smooth.smooth(file, z="data")
    file.write(tmp_path / "out.vtk", result)
    after = gpu_smooth.MeshFile(tmp_path / "out.vtk")
    assert (after.points != file.points).any()
    np.testing.assert_array_equal(after.data("z"), file.data("z"))
    assert (tmp_path / "out.vtk").read_text().endswith(f"LOOKUP_TABLE default\n{values}\n")
