"""Remarks of results, and warnings, say in words of Python what the command line says."""

from __future__ import annotations

import pickle
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from conftest import MESHES, Points, Triangles, alternating, command_line, lattice, squares, written

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


def test_a_warning_names_the_line_that_called_the_package(mesh: Mesh) -> None:
    points, triangles = mesh
    points = points * [6.0, 1.0]
    in_space = np.column_stack([points, np.zeros(len(points))])
    given = meshio.Mesh(in_space, [("triangle", triangles)])
    calls: list[Callable[[], Any]] = [
        lambda: gpu_smooth.smooth(points, triangles),
        lambda: gpu_smooth.run(points, triangles),
        lambda: gpu_smooth.Smoother(points, triangles).run(),
        lambda: gpu_smooth.smooth(given),
        lambda: gpu_smooth.run(given),
    ]
    for call in calls:
        with warnings.catch_warnings(record=True) as caught:
            # Python's usual filter shows a warning once for each line.
            warnings.simplefilter("default")
            call()
        assert [(Path(own.filename).name, own.lineno) for own in caught] == [(Path(__file__).name, call.__code__.co_firstlineno)]


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
    assert between == 11 and "slide=True" in told, "vertices of the boundary are not counted"
    result = gpu_smooth.run(points, triangles, regions=regions, slide=True)
    assert re.match(r"slide: \d+ vertices on the boundary and other lines may slide$", remark(result, "slide: "))
    rows = np.arange(1, 12) * 13
    pairs = np.stack([rows, rows + 12], axis=1)
    result = gpu_smooth.run(points, triangles, slide=True, periodic=pairs)
    assert remark(result, "slide: ").endswith("22 of them in 11 periodic pairs")
    pairs[0, 1] += 13 * 11
    with pytest.warns(MeshWarning, match="periodic: 1 pair stays"):
        gpu_smooth.run(points, triangles, slide=True, periodic=pairs)


def periodic_pairs() -> Triangles:
    """Return the pairs of vertices on the left and the right side of `lattice(12)`, without those at corners."""
    rows = np.arange(1, 12) * 13
    return np.stack([rows, rows + 12], axis=1)


def test_a_periodic_pair_with_a_vertex_inside_the_mesh_is_a_warning(mesh: Mesh) -> None:
    points, triangles = mesh
    # Vertex 70 is inside the mesh. No translation has to fit, as the pair is the only one.
    with pytest.warns(MeshWarning, match=r"periodic\[0\]: vertex 70 is inside the mesh, .* The pair does not slide") as caught:
        result = gpu_smooth.run(points, triangles, slide=True, periodic=[[65, 70]])
    assert len(caught) == 1 and np.array_equal(result.points[65], points[65])
    pairs = np.concatenate([periodic_pairs(), [[3, 70], [83, 70]]])
    with pytest.warns(MeshWarning, match=r"periodic\[11\]: vertex 70 .* This pair and 1 more do not slide") as caught:
        result = gpu_smooth.run(points, triangles, slide=True, periodic=pairs)
    assert len(caught) == 1
    assert remark(result, "slide: ").endswith("22 of them in 11 periodic pairs")


def test_vertices_that_stay_because_of_their_pairs_are_a_warning(mesh: Mesh) -> None:
    points, triangles = mesh
    pairs = periodic_pairs()
    # Pairs of two corners are usual, and hold no other vertex.
    gpu_smooth.run(points, triangles, slide=True, periodic=np.concatenate([pairs, [[0, 12], [156, 168]]]))
    # Vertex 0 is a corner of the square, and vertex 6 is not.
    with pytest.warns(MeshWarning, match="periodic: 1 vertex stays that could slide without pairs") as caught:
        result = gpu_smooth.run(points, triangles, slide=True, periodic=[[0, 6]])
    assert len(caught) == 1 and np.array_equal(result.points[6], points[6])
    # The two pairs beside the pair that is left out have neighbors without a pair.
    with pytest.warns(MeshWarning, match="periodic: 4 vertices stay that could slide"):
        gpu_smooth.run(points, triangles, slide=True, periodic=np.delete(pairs, 5, axis=0))
    with pytest.warns(MeshWarning, match="periodic: 1 vertex stays that could slide"):
        gpu_smooth.run(points, triangles, slide=True, periodic=pairs, fixed=[65])


def test_pairs_of_lines_that_are_no_edges_are_a_warning(mesh: Mesh) -> None:
    points, triangles = mesh
    edges = np.stack([np.arange(66, 76), np.arange(67, 77)], axis=1)
    gpu_smooth.run(points, triangles, lines=edges)
    for slide in False, True:
        with pytest.warns(MeshWarning, match=r"lines\[2\]: no edge of the mesh joins vertices 66 and 68. Both vertices stay"):
            gpu_smooth.run(points, triangles, lines=[[66, 67], [68, 67], [66, 68]], slide=slide)
        with pytest.warns(MeshWarning, match=r"lines\[0\]: .* 66 and 66, and 2 more pairs are no edges"):
            gpu_smooth.smooth(points, triangles, lines=[[66, 66], [66, 67], [1, 100], [30, 1]], slide=slide)
    # The diagonals of quadrilaterals are no edges, whatever their corner triangles are.
    with pytest.warns(MeshWarning, match=r"lines\[1\]: no edge of the mesh joins vertices 66 and 80"):
        gpu_smooth.run(points, [], quadrilaterals=squares(12), lines=[[66, 67], [66, 80]])
    gpu_smooth.run(points, triangles, lines=[[66, 68]], free_lines=True)
    # A network of lines beside the mesh is no mistake.
    with_network = np.concatenate([points, [[20.0, 1.0], [21.0, 1.0]]])
    gpu_smooth.run(with_network, triangles, lines=[[169, 170]])


def test_hanging_nodes_are_a_remark(mesh: Mesh) -> None:
    points, triangles = mesh
    # The lower of the two triangles at an edge is cut in two, but not the upper one.
    a, b, c = triangles[30]
    middle = len(points)
    cut = np.concatenate([np.delete(triangles, 30, axis=0), [[a, middle, c], [middle, b, c]]])
    given = np.concatenate([points, [0.5 * (points[a] + points[b])]])
    result = gpu_smooth.run(given, cut)
    told = remark(result, "points: 1 hanging node: vertex ")
    assert f"vertex {middle} is inside the edge between vertices {min(a, b)} and {max(a, b)}" in told


def test_a_run_without_a_vertex_to_move_ends_as_nothing_to_do(mesh: Mesh, tmp_path: Path) -> None:
    points, triangles = mesh
    path = written(tmp_path / "in.vtk", points, triangles)
    report = gpu_smooth.smooth_file(path, tmp_path / "out.vtk", only_bad=1e6, engine="cpu")
    good = gpu_smooth.run(points, triangles, only_bad=1e6, engine="cpu")
    assert (good.stop, good.sweeps) == ("nothing-to-do", 0) and good.stop == report["stop"]
    assert repr(good).startswith("Result(nothing-to-do after 0 sweeps") and pickle.loads(pickle.dumps(good)).stop == good.stop
    with pytest.warns(MeshWarning, match="every free vertex is in a boundary layer"):
        kept = gpu_smooth.run(points, triangles, keep_layers=("within=100", [0, 1]))
    assert kept.stop == "nothing-to-do" and np.array_equal(kept.points, points)
    # Vertices could move here, but no sweep was allowed.
    assert gpu_smooth.run(points, triangles, max_sweeps=0).stop == "max-sweeps"


def test_vertices_near_bad_triangles_are_counted(mesh: Mesh, tmp_path: Path) -> None:
    points, triangles = mesh
    words = (written(tmp_path / "in.vtk", points, triangles), tmp_path / "out.vtk", "--only-bad", "1.6")
    told = re.search(r"(\d+) triangles? above it; .* (\d+ of \d+ free vertices may move)", command_line(*words).stderr)
    assert told
    kept = gpu_smooth.run(points, triangles, only_bad=1e6, keep_layers="none", slide=True)
    assert remark(kept, "only_bad: ").startswith("only_bad: 0 triangles are above")
    assert np.array_equal(kept.points, points)
    ours = remark(gpu_smooth.run(points, triangles, only_bad=1.6), "only_bad: ")
    assert ours.startswith(f"only_bad: {told[1]} triangle") and ours.endswith(told[2])


@pytest.mark.parametrize("measure", ["imr", "min-angle", "altitude"])
def test_improved_worst_triangles_are_a_remark(tmp_path: Path, measure: Any) -> None:
    path = MESHES / "hand.node"
    done = command_line(path, tmp_path / "out.node", f"--improve-worst={measure}", "--engine", "cpu")
    told = re.search(r"the (?:worst|least) \w+ of movable triangles was improved from .*", done.stdout)
    assert told, done.stdout
    file = gpu_smooth.MeshFile(path)
    ours = remark(gpu_smooth.run(file, improve_worst=measure, engine="cpu"), "improve_worst: ")
    texts = [re.sub(r"[0-9.]+", "0", text) for text in (ours, f"improve_worst: {told[0]}")]
    assert texts[0] == texts[1]
    numbers = [[float(n) for n in re.findall(r"[0-9]+(?:[.][0-9]+)?", text)] for text in (ours, told[0])]
    assert numbers[0] == pytest.approx(numbers[1], rel=1e-4)


def test_a_worse_worst_triangle_is_a_remark_with_a_remedy(tmp_path: Path) -> None:
    points, triangles = alternating(12)
    words = written(tmp_path / "in.vtk", points, triangles), tmp_path / "out.vtk", "--method", "multilevel"
    done = command_line(*words, "--engine", "cpu")
    told = re.search(r"worst imr rose from (\S+) to (\S+): f is a mean, .*--guard worst", done.stdout)
    assert told, done.stdout
    result = gpu_smooth.run(points, triangles, method="multilevel", engine="cpu")
    ours = remark(result, "worst imr of movable triangles rose from ")
    assert 'guard="worst"' in ours
    found = re.search(r"rose from (\S+) to (\S+):", ours)
    assert found and float(found[1]) == pytest.approx(float(told[1]), rel=1e-5)
    assert float(found[2]) == pytest.approx(float(told[2]), rel=1e-3)
    assert "rose from" not in str(gpu_smooth.run(points, triangles).remarks)


def test_the_end_of_a_run_has_remarks() -> None:
    file = gpu_smooth.MeshFile(MESHES / "hand.node")
    result = gpu_smooth.run(file.points, file.triangles)
    assert result.floored > 0
    told = remark(result, "the sweeps left a least angle of ")
    assert f"{result.floored} vertices moved on or went back" in told and "changed f by" in told
    result = gpu_smooth.run(file.points, file.triangles, scheme="rms", guard="worst")
    assert remark(result, "a guard keeps ").startswith(f"a guard keeps {result.held_back} vert")
    assert pickle.loads(pickle.dumps(result)).remarks == result.remarks
