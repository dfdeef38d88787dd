"""Remarks of results, and warnings, say in words of Python what the command line says."""

from __future__ import annotations

import pickle
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import MESHES, Points, Triangles, command_line, lattice, written

import gpu_smooth
from gpu_smooth import MeshWarning

Mesh = tuple[Points, Triangles]


def with_rows() -> Mesh:
    """Return a mesh whose rows at the lower side grow by 1.4."""
    points, triangles = lattice(12, by=0.0)
    points[:, 1] = 12.0 * (1.4 ** points[:, 1] - 1.0) / (1.4**12 - 1.0)
    return points, triangles


def remark(result: gpu_smooth.Result, start: str) -> str:
    found = [remark for remark in result.remarks if remark.startswith(start)]
    assert len(found) == 1, result.remarks
    return found[0]


def test_a_warning_is_a_user_warning_and_may_be_made_an_exception(mesh: Mesh) -> None:
    assert issubclass(MeshWarning, UserWarning)
    points, triangles = mesh
    # The settings of the tests make all warnings exceptions.
    with pytest.raises(MeshWarning, match="adapted"):
        gpu_smooth.smooth(points * [6.0, 1.0], triangles)


@pytest.mark.parametrize("kind", ["stretched", "graded"])
def test_an_adapted_mesh_is_a_warning_with_the_numbers_of_the_command_line(
    kind: str, mesh: Mesh, tmp_path: Path
) -> None:
    points, triangles = mesh
    if kind == "stretched":
        points, target = points * [6.0, 1.0], "keep-shape"
    else:
        # A map that keeps angles, under which sizes grow with x.
        image = np.exp(0.2 * (points[:, 0] + 1j * points[:, 1]))
        points, target = np.stack([image.real, image.imag], axis=1), "keep-size"
    done = command_line(written(tmp_path / "in.vtk", points, triangles), tmp_path / "out.vtk")
    told = re.search(r"the mesh is (adapted|graded): .*?-fold", done.stderr)
    assert told and target in done.stderr, done.stderr
    message = f'{re.escape(told[0])}.* target="{target}"'
    with pytest.warns(MeshWarning, match=message) as caught:
        result = gpu_smooth.run(points, triangles)
    assert result.remarks[0] == str(caught[0].message)
    with pytest.warns(MeshWarning, match=message) as caught:
        gpu_smooth.smooth(points, triangles)
    # The warning names the line of the caller.
    assert caught[0].filename == __file__
    # A run with a target, or by a metric of sizes, is meant to do what it does.
    choices: list[dict[str, Any]] = [{"target": target}, {"scheme": "soft-size"}]
    for kept in choices:
        assert "the mesh is" not in str(gpu_smooth.run(points, triangles, **kept).remarks)


def test_boundary_layers_are_a_remark(tmp_path: Path) -> None:
    points, triangles = with_rows()
    done = command_line(written(tmp_path / "in.vtk", points, triangles), tmp_path / "out.vtk")
    told = re.search(r"layers: (\d+ vertices in \d+ rows) at", done.stderr)
    assert told, done.stderr
    result = gpu_smooth.run(points, triangles, target="keep-shape")
    assert told[1] in remark(result, "keep_layers")
    assert not gpu_smooth.run(points, triangles, target="keep-shape", keep_layers="none").remarks


def test_the_weight_of_sizes_is_a_remark() -> None:
    points, triangles = with_rows()
    result = gpu_smooth.run(points, triangles, target="keep-size", keep_layers="none")
    assert re.search(r"weight of \d", remark(result, 'target="keep-size"'))


def test_coordinates_like_degrees_are_a_warning_unless_the_surface_is_named(mesh: Mesh) -> None:
    points, triangles = mesh
    for offset in [10.0, 40.0], [-100.0, -60.0]:
        with pytest.warns(MeshWarning, match='look like degrees. Pass surface="sphere"'):
            result = gpu_smooth.run(points + offset, triangles)
        remark(result, "points: the coordinates look like degrees")
        for surface in "plane", "sphere":
            assert not gpu_smooth.run(points + offset, triangles, surface=surface).remarks
    for other in points, points + [0.0, 15.0], points + [400.0, 40.0], points - [0.0, 40.0] + 200.0:
        gpu_smooth.smooth(other, triangles)


def test_vertices_outside_of_the_mesh_of_a_target_are_a_remark(mesh: Mesh) -> None:
    points, triangles = mesh
    corners = np.array([[0.0, 0.0], [11.0, 0.0], [12.0, 12.0], [0.0, 12.0]])
    background = corners, np.array([[0, 1, 2], [0, 2, 3]]), np.ones(4)
    told = remark(gpu_smooth.run(points, triangles, target=background), "target: ")
    assert re.match(r"target: \d+ vertices are outside of the other mesh, by up to [01]\.\d+\. ", told)


def test_vertices_between_regions_and_sliding_vertices_are_remarks(mesh: Mesh) -> None:
    points, triangles = mesh
    regions = (points[triangles].mean(axis=1)[:, 0] > 6.0).astype(int)
    told = remark(gpu_smooth.run(points, triangles, regions=regions), "regions: ")
    between = int(re.findall(r"\d+", told)[0])
    assert between == 13 and "slide=True" in told
    result = gpu_smooth.run(points, triangles, regions=regions, slide=True)
    assert re.match(r"slide: \d+ vertices on the boundary and other lines may slide$", remark(result, "slide: "))
    rows = np.arange(1, 12) * 13
    pairs = np.stack([rows, rows + 12], axis=1)
    result = gpu_smooth.run(points, triangles, slide=True, periodic=pairs)
    assert remark(result, "slide: ").endswith("22 of them in 11 periodic pairs")
    pairs[0, 1] += 13 * 11
    with pytest.warns(MeshWarning, match="periodic: 1 pair stays"):
        gpu_smooth.run(points, triangles, slide=True, periodic=pairs)


def test_the_end_of_a_run_has_remarks() -> None:
    file = gpu_smooth.MeshFile(MESHES / "hand.node")
    result = gpu_smooth.run(file.points, file.triangles)
    assert result.floored > 0
    told = remark(result, "the sweeps left a least angle of ")
    assert f"{result.floored} vertices moved on or went back" in told
    result = gpu_smooth.run(file.points, file.triangles, scheme="rms", guard="worst")
    assert remark(result, "a guard keeps ").startswith(f"a guard keeps {result.held_back} vert")
    assert pickle.loads(pickle.dumps(result)).remarks == result.remarks
