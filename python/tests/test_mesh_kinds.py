"""Meshes of other packages and of files in every function that takes a mesh."""

from __future__ import annotations

import dataclasses
import pickle
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import numpy.typing as npt
import pytest
from conftest import MESHES, Points, Triangles, lattice

import gpu_smooth

Mesh = tuple[Points, Triangles]


@dataclasses.dataclass(frozen=True)
class MeshTri1:
    """A mesh with the attributes of a `skfem.MeshTri1`."""

    doflocs: npt.NDArray[np.float64]
    t: npt.NDArray[np.int32]
    facets: npt.NDArray[np.int32]
    boundaries: dict[str, npt.NDArray[np.int32]] | None = None
    subdomains: dict[str, npt.NDArray[np.int32]] | None = None

    @property
    def p(self) -> npt.NDArray[np.float64]:
        return self.doflocs


class MeshTri2(MeshTri1):
    """A mesh of curved triangles."""


for kind in (MeshTri1, MeshTri2):
    kind.__module__ = "skfem.mesh.mesh_tri_1"


def of_skfem(points: Points, triangles: Triangles, kind: type[MeshTri1] = MeshTri1) -> MeshTri1:
    """Return a mesh with the column 6 as a boundary, and the part right of it and the upper part as subdomains."""
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    facets = np.unique(sides, axis=0)
    is_in_column = (facets % 13 == 6).all(axis=1)
    boundaries = {"column": np.flatnonzero(is_in_column).astype(np.int32)}
    corner = triangles[:, 0]
    subdomains = {
        "right": np.flatnonzero(corner % 13 >= 6).astype(np.int32),
        "top": np.flatnonzero(corner // 13 >= 8).astype(np.int32),
    }
    own = (points.T.copy(), triangles.T.astype(np.int32), facets.T.astype(np.int32))
    return kind(*own, boundaries, subdomains)


def test_boundaries_and_subdomains_of_scikit_fem_are_held(mesh: Mesh) -> None:
    points, triangles = mesh
    given = of_skfem(points, triangles)
    smoothed = gpu_smooth.smooth(given)
    assert type(smoothed) is MeshTri1 and smoothed.subdomains is given.subdomains
    column, row = np.arange(len(points)) % 13 == 6, np.arange(len(points)) // 13 == 8
    moved = (smoothed.p != given.p).any(axis=0)
    assert not moved[column | row].any() and moved.sum() > 80
    vertices = np.flatnonzero(column)
    lines = np.stack([vertices[:-1], vertices[1:]], axis=1)
    regions = (triangles[:, 0] % 13 >= 6) * 2 + (triangles[:, 0] // 13 >= 8)
    expected = gpu_smooth.smooth(points, triangles, lines=lines, regions=regions)
    assert np.array_equal(smoothed.p.T, expected)
    slid = gpu_smooth.run(given, slide=True, method="multilevel")
    assert slid.slid > 0
    held = gpu_smooth.smooth(given, slide=True, fixed="column", method="multilevel")
    assert np.array_equal(held.p[:, column], given.p[:, column])
    with pytest.raises(gpu_smooth.MeshError, match="no group 'inlet'. Its groups are: column, right, top"):
        gpu_smooth.smooth(given, fixed="inlet")
    with pytest.raises(gpu_smooth.MeshError, match="MeshTri2 is not accepted. Pass a MeshTri or MeshQuad of linear elements"):
        gpu_smooth.smooth(of_skfem(points, triangles, MeshTri2))


@pytest.mark.parametrize("kind", ["meshio", "skfem"])
def test_every_function_takes_a_mesh_and_results_have_one(mesh: Mesh, kind: str) -> None:
    points, triangles = mesh
    middle = np.flatnonzero(np.arange(len(points)) % 13 == 6)
    given: Any = of_skfem(points, triangles)
    if kind == "meshio":
        given = meshio.Mesh(points, [("triangle", triangles), ("vertex", middle[:, None])])

    def own(mesh: Any) -> Any:
        return mesh.points if kind == "meshio" else mesh.p.T

    smoothed = own(gpu_smooth.smooth(given))
    result = gpu_smooth.run(given)
    assert type(result.mesh) is type(given) and np.array_equal(own(result.mesh), smoothed)
    assert np.array_equal(result.points[middle], points[middle])
    if kind == "meshio":
        assert np.array_equal(own(pickle.loads(pickle.dumps(result)).mesh), smoothed)
    angles = gpu_smooth.quality(points, triangles, "min-angle")
    assert np.array_equal(gpu_smooth.quality(given, measure="min-angle"), angles)
    smoother = gpu_smooth.Smoother(given)
    assert not smoother.free[middle].any()
    again = smoother.run(points * 2.0)
    assert np.array_equal(own(again.mesh), again.points) and not np.array_equal(own(again.mesh), smoothed)
    assert gpu_smooth.run(points, triangles).mesh is None
    assert np.array_equal(own(given), points), "the given mesh is not changed"


@pytest.mark.parametrize("name", ["plate.node", "fish.node"])
@pytest.mark.parametrize("slide", [False, True])
def test_a_mesh_file_is_smoothed_as_by_the_command_line(tmp_path: Path, name: str, slide: bool) -> None:
    path = MESHES / name
    file = gpu_smooth.MeshFile(path)
    out, expected = tmp_path / f"a{path.suffix}", tmp_path / f"b{path.suffix}"
    file.write(out, gpu_smooth.smooth(file, slide=slide, engine="cpu"), slide=slide)
    gpu_smooth.smooth_file(path, expected, slide=slide, engine="cpu")
    ours, theirs = gpu_smooth.MeshFile(out).points, gpu_smooth.MeshFile(expected).points
    assert np.array_equal(ours, theirs)
    assert not np.array_equal(ours, file.points)


def test_groups_regions_and_third_coordinates_of_a_file_are_used(tmp_path: Path) -> None:
    points, triangles = lattice(8)
    points = np.c_[points, points[:, 0] * 0.5]
    left = triangles[:, 0] % 9 < 4
    wall = np.flatnonzero(np.arange(81) // 9 == 3)
    lines = np.stack([wall[:-1], wall[1:]], axis=1)
    cells = [("line", lines), ("triangle", triangles)]
    numbers = [np.full(len(lines), 5), np.where(left, 1, 2)]
    names = {"wall": np.array([5, 1]), "left": np.array([1, 2]), "right": np.array([2, 2])}
    data: Any = {"gmsh:physical": numbers, "gmsh:geometrical": numbers}
    meshio.Mesh(points, cells, cell_data=data, field_data=names).write(tmp_path / "in.msh", file_format="gmsh22")
    file = gpu_smooth.MeshFile(tmp_path / "in.msh")
    result = gpu_smooth.run(file)
    assert result.points.shape == (81, 3) and result.mesh is None
    moved = (result.points != points).any(axis=1)
    assert not moved[np.arange(81) % 9 == 4].any() and not moved[wall].any() and moved.sum() > 20
    assert np.abs(result.points[:, 2] - 0.5 * result.points[:, 0]).max() < 1e-12
    file.write(tmp_path / "out.msh", result.points)
    assert np.array_equal(gpu_smooth.run(gpu_smooth.MeshFile(tmp_path / "out.msh")).points_before, result.points)
    slid = gpu_smooth.smooth(file, slide=True, fixed="wall", method="multilevel")
    assert np.array_equal(slid[wall], points[wall]) and (slid != points).any(axis=1)[np.arange(81) % 9 == 4].any()
    for slides in (False, True):
        ours = gpu_smooth.smooth(file, slide=slides, engine="cpu")
        gpu_smooth.smooth_file(tmp_path / "in.msh", tmp_path / "by-cli.msh", slide=slides, engine="cpu")
        by_command_line = gpu_smooth.MeshFile(tmp_path / "by-cli.msh")
        assert np.array_equal(np.c_[by_command_line.points, by_command_line.data("z")], ours)
    values = gpu_smooth.quality(file, measure="imr")
    assert np.array_equal(values, gpu_smooth.quality(points, triangles, "imr"))


def test_other_objects_in_place_of_a_mesh_are_refused() -> None:
    for call in (gpu_smooth.smooth, gpu_smooth.run, gpu_smooth.quality, gpu_smooth.Smoother):
        with pytest.raises(TypeError, match="a mesh of meshio, PyVista, .*, or a MeshFile, not an object of type dict"):
            call({})
        with pytest.raises(TypeError, match="not the name of a file"):
            call("mesh.msh")


def test_meshes_of_scikit_fem_itself_are_smoothed() -> None:
    skfem = pytest.importorskip("skfem")
    given = skfem.MeshTri().refined(3).with_boundaries({"left": lambda x: x[0] == 0.0})
    given = given.with_subdomains({"lower": lambda x: x[1] < 0.5})
    rng = np.random.default_rng(1)
    is_inner = ((given.p > 0) & (given.p < 1) & (np.abs(given.p[1] - 0.5) > 0)).all(axis=0)
    given = dataclasses.replace(given, doflocs=given.p + 0.03 * is_inner * rng.uniform(-1, 1, given.p.shape))
    smoothed = gpu_smooth.run(given).mesh
    assert type(smoothed) is type(given) and smoothed.p.shape == given.p.shape
    assert set(smoothed.boundaries) == {"left"} and np.array_equal(smoothed.t, given.t)
    moved = (smoothed.p != given.p).any(axis=0)
    assert moved.sum() > 20 and not moved[given.p[1] == 0.5].any()
    with pytest.raises(gpu_smooth.MeshError, match="MeshTri2 is not accepted"):
        gpu_smooth.quality(skfem.MeshTri2.from_mesh(given))
