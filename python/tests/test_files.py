"""Mesh files, the command line of the wheel, and examples in docstrings."""

from __future__ import annotations

import doctest
import importlib
import inspect
import pickle
import pkgutil
import shutil
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
from conftest import MESHES, command_line, lattice

import gpu_smooth
from gpu_smooth import FileError, GpuSmoothError, MeshError, OptionError


def gmsh_file(path: Path) -> Path:
    """Write a square of two regions, with a named line and a depth at each vertex."""
    nodes = [(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (0, 1), (0.6, 0.4), (1.4, 0.7)]
    left = [(1, 2, 7), (2, 5, 7), (5, 6, 7), (6, 1, 7)]
    right = [(2, 3, 8), (3, 4, 8), (4, 5, 8), (5, 2, 8)]
    elements = [f"1 1 2 3 1 1 2", *(
        f"{2 + k} 2 2 {tag} {tag} " + " ".join(map(str, corners))
        for k, (tag, corners) in enumerate([*[(1, t) for t in left], *[(2, t) for t in right]])
    )]
    path.write_text("\n".join([
        "$MeshFormat", "2.2 0 8", "$EndMeshFormat",
        "$PhysicalNames", "3", '1 3 "inlet"', '2 1 "left"', '2 2 "right"', "$EndPhysicalNames",
        "$Nodes", str(len(nodes)), *(f"{k} {x} {y} 0.50" for k, (x, y) in enumerate(nodes, 1)), "$EndNodes",
        "$Elements", str(len(elements)), *elements, "$EndElements",
        "$NodeData", "1", '"depth"', "1", "0", "3", "0", "1", str(len(nodes)),
        *(f"{k} {k}.25" for k in range(1, len(nodes) + 1)), "$EndNodeData", "",
    ]))
    return path


def test_a_file_is_read_and_written_with_moved_vertices_alone(tmp_path: Path) -> None:
    file = gpu_smooth.MeshFile(gmsh_file(tmp_path / "in.msh"))
    assert file.format.startswith("gmsh 2.2") and file.path == tmp_path / "in.msh"
    assert file.points.shape == (8, 2) and file.triangles.shape == (8, 3)
    assert file.regions is not None and len(set(file.regions.tolist())) == 2
    names = {group.name: group for group in file.groups}
    assert names["inlet"].dimension == 1 and names["inlet"].vertices.tolist() == [0, 1]
    assert names["left"].triangles.tolist() == [0, 1, 2, 3] and names["right"].tag == 2
    assert file.data("depth").tolist() == [k + 1.25 for k in range(8)]
    assert "depth" in file.data_names and file.lines.tolist() == [[0, 1]]
    assert "8 vertices, 8 triangles" in repr(file)
    smoothed = gpu_smooth.smooth(
        file.points, file.triangles, regions=file.regions, lines=file.lines, fixed=file.anchored
    )
    file.write(tmp_path / "out.msh", smoothed)
    out = gpu_smooth.MeshFile(tmp_path / "out.msh")
    assert np.array_equal(out.points, smoothed) and file.difference(out) is None
    before, after = ((tmp_path / name).read_text().split("\n") for name in ("in.msh", "out.msh"))
    differing = [k for k, (was, now) in enumerate(zip(before, after)) if was != now]
    assert len(before) == len(after) and [before[k].split()[0] for k in differing] == ["7", "8"]
    done = command_line(tmp_path / "in.msh", tmp_path / "cli.msh")
    assert done.returncode == 0 and (tmp_path / "cli.msh").read_bytes() == (tmp_path / "out.msh").read_bytes()
    with pytest.raises(FileError, match="none"):
        file.data("none")
    with pytest.raises(MeshError, match="points: "):
        file.write(tmp_path / "out.msh", smoothed[:3])
    with pytest.raises(FileError, match="missing"):
        file.write(tmp_path / "missing" / "out.msh", smoothed)
    with pytest.raises(FileError, match="none.msh"):
        gpu_smooth.MeshFile(tmp_path / "none.msh")


def test_groups_list_their_quadrilaterals(tmp_path: Path) -> None:
    # The second cell lists a vertex twice, and is no row of the file's quadrilaterals.
    cells = ["4 0 1 5 4", "4 1 6 6 5", "4 2 3 7 6"]
    (tmp_path / "in.vtk").write_text("\n".join([
        "# vtk DataFile Version 3.0", "cells", "ASCII", "DATASET UNSTRUCTURED_GRID",
        "POINTS 8 double", *(f"{k % 4} {k // 4} 0" for k in range(8)),
        "CELLS 3 15", *cells, "CELL_TYPES 3", "9", "9", "9",
        "CELL_DATA 3", "SCALARS MaterialIDs int 1", "LOOKUP_TABLE default", "1", "1", "2", "",
    ]))
    file = gpu_smooth.MeshFile(tmp_path / "in.vtk")
    assert file.quadrilaterals.tolist() == [[0, 1, 5, 4], [2, 3, 7, 6]]
    assert [group.quadrilaterals.tolist() for group in file.groups] == [[0], [1]]
    assert [group.triangles.tolist() for group in file.groups] == [[], []]


@pytest.mark.filterwarnings("ignore:points. the mesh is:gpu_smooth.MeshWarning")
def test_the_ends_of_groups_stay_where_vertices_slide(tmp_path: Path) -> None:
    # The bottom of a square: an inlet up to x = 0.62, then a wall.
    x = [0, 0.15, 0.3, 0.45, 0.62, 0.7, 0.8, 0.9, 1]
    points = [(a, b) for b in (0, 0.25, 0.5, 0.75, 1) for a in x]
    cells = [9 * row + column for row in range(4) for column in range(8)]
    triangles = [t for a in cells for t in ((a, a + 1, a + 10), (a, a + 10, a + 9))]
    markers = [
        f"MARKER_TAG= {name}\nMARKER_ELEMS= 4\n" + "".join(f"3 {a} {a + 1}\n" for a in edges)
        for name, edges in (("inlet", range(4)), ("wall", range(4, 8)))
    ]
    path = tmp_path / "in.su2"
    path.write_text(
        "NDIME= 2\nNELEM= 64\n" + "".join(f"5 {a} {b} {c}\n" for a, b, c in triangles)
        + "NPOIN= 45\n" + "".join(f"{a} {b}\n" for a, b in points) + "NMARK= 2\n" + "".join(markers)
    )
    file = gpu_smooth.MeshFile(path)
    assert file.anchored.tolist() == [0, 4, 8]
    own = gpu_smooth.smooth(file.points, file.triangles, lines=file.lines, fixed=file.anchored, slide=True)
    assert own[4].tolist() == [0.62, 0] and own[3, 0] != 0.45
    lines = np.array([[a, a + 1] for a in range(8)])
    of_lines = np.array([1] * 4 + [2] * 4)
    given = meshio.Mesh(
        np.array(points), [("line", lines), ("triangle", np.array(triangles))],
        cell_data={"gmsh:physical": [of_lines, np.full(64, 3)]},
    )
    smoothed = gpu_smooth.smooth(given, slide=True)
    assert np.array_equal(smoothed.points[:9], own[:9])
    without = meshio.Mesh(given.points, given.cells)
    assert gpu_smooth.smooth(without, slide=True).points[4, 0] != 0.62
    without.cell_sets = {"inlet": [np.arange(4), np.array([], int)]}
    assert gpu_smooth.smooth(without, slide=True).points[4].tolist() == [0.62, 0]
    without.cell_sets, without.point_sets = {}, {"inlet": np.arange(5)}
    assert gpu_smooth.smooth(without, slide=True).points[4].tolist() == [0.62, 0]
    # A number for each line is no group.
    given.cell_data["gmsh:physical"][0] = np.arange(1, 9)
    assert gpu_smooth.smooth(given, slide=True).points[4, 0] != 0.62


def test_a_file_is_smoothed_as_by_the_command_line(tmp_path: Path) -> None:
    source = gmsh_file(tmp_path / "in.msh")
    report = gpu_smooth.smooth_file(source, tmp_path / "out.msh", slide=True, fix=["inlet"], tolerance=1e-4)
    assert report["stop"] == "converged" or "stop" not in report
    words = ["--slide", "--fix", "inlet", "--tolerance", "1e-4"]
    assert command_line(source, tmp_path / "cli.msh", *words).returncode == 0
    assert (tmp_path / "out.msh").read_bytes() == (tmp_path / "cli.msh").read_bytes()
    with pytest.raises(OptionError, match="--tolerence"):
        gpu_smooth.smooth_file(source, tmp_path / "out.msh", tolerence=1)
    with pytest.raises(FileError, match="none.msh"):
        gpu_smooth.smooth_file(tmp_path / "none.msh", tmp_path / "out.msh")
    with pytest.raises(FileError, match="missing"):
        gpu_smooth.smooth_file(source, tmp_path / "missing" / "out.msh")
    with pytest.raises(GpuSmoothError):
        gpu_smooth.smooth_file(source, tmp_path / "out.msh", strict=True, max_sweeps=0)


def test_a_file_is_converted(tmp_path: Path) -> None:
    source = gmsh_file(tmp_path / "in.msh")
    losses = gpu_smooth.convert(source, tmp_path / "out.vtk", lossy=True)
    assert np.array_equal(gpu_smooth.MeshFile(tmp_path / "out.vtk").points, gpu_smooth.MeshFile(source).points)
    assert any("inlet" in loss for loss in losses)
    with pytest.raises(FileError, match="lossy=True"):
        gpu_smooth.convert(source, tmp_path / "other.vtk")
    with pytest.raises(FileError, match="the ending belongs to no format"):
        gpu_smooth.convert(source, tmp_path / "out.docx")
    gpu_smooth.convert(source, tmp_path / "out.vtu", lossy=True, encoding="compressed")
    assert b"vtkZLibDataCompressor" in (tmp_path / "out.vtu").read_bytes()
    assert np.array_equal(gpu_smooth.MeshFile(tmp_path / "out.vtu").points, gpu_smooth.MeshFile(source).points)
    with pytest.raises(FileError, match="not written in this encoding"):
        gpu_smooth.convert(source, tmp_path / "out.off", lossy=True, encoding="binary")


def test_the_command_line_is_in_the_wheel(plate: Path, tmp_path: Path) -> None:
    script = shutil.which("gpu-smooth", path=str(Path(sys.executable).parent))
    assert script is not None
    done = subprocess.run([script, "--version"], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == f"gpu-smooth {gpu_smooth.__version__}" and done.returncode == 0
    assert command_line("--version").stdout == done.stdout
    assert "Usage: gpu-smooth [OPTIONS] <IN> <OUT>" in command_line("--help").stdout
    assert "gpu-smooth" in command_line("completions", "bash").stdout
    for word, code in (("adapters", 0), ("metrics", 0), ("none.msh", 2), ("quality", 2)):
        assert command_line(word).returncode == code, word
    assert command_line("quality", tmp_path / "none.msh").returncode == 3
    assert command_line(plate, tmp_path / "none" / "out.node").returncode == 4
    done = command_line(plate, tmp_path / "out.node", "--engine", "gpu")
    assert done.returncode == 0 and "converged" in done.stdout, done.stderr


def test_examples_in_docstrings_hold() -> None:
    tried = 0
    for module in pkgutil.iter_modules(gpu_smooth.__path__, "gpu_smooth."):
        # The accessor needs PyVista, and has no examples.
        if module.name not in ("gpu_smooth.__main__", "gpu_smooth._accessor"):
            result = doctest.testmod(importlib.import_module(module.name))
            assert result.failed == 0, module.name
            tried += result.attempted
    result = doctest.testmod(gpu_smooth)
    assert result.failed == 0 and tried + result.attempted > 20


def test_public_functions_say_what_they_return_and_raise() -> None:
    for name in gpu_smooth.__all__:
        thing = getattr(gpu_smooth, name)
        if isinstance(thing, str):
            continue
        text = inspect.getdoc(thing) or ""
        assert text, name
        if callable(thing) and not isinstance(thing, type) and thing.__code__.co_argcount:
            assert "Parameters\n----" in text and "Returns\n----" in text, name
            assert "Raises\n----" in text, name


def test_names_may_begin_with_a_hyphen_and_be_bytes(
    plate: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    gpu_smooth.convert(plate, b"-in.vtk", lossy=True)
    gpu_smooth.smooth_file("-in.vtk", b"-out.vtk", report=b"report.json")
    gpu_smooth.MeshFile(b"-in.vtk").write(b"same.vtk", gpu_smooth.MeshFile("-out.vtk").points)
    assert Path("same.vtk").read_bytes() == Path("-out.vtk").read_bytes() and Path("report.json").exists()


def test_options_of_smooth_file_are_those_of_python(plate: Path, tmp_path: Path) -> None:
    destination = tmp_path / "out.node"
    of_true = gpu_smooth.smooth_file(plate, destination, slide=np.True_, quiet=True)
    slid = gpu_smooth.MeshFile(destination).points
    gpu_smooth.smooth_file(plate, destination, slide=np.False_)
    assert of_true["sweeps"] and not np.array_equal(slid, gpu_smooth.MeshFile(destination).points)
    for name in ("dry_run", "help", "version"):
        with pytest.raises(gpu_smooth.OptionError, match="written no report"):
            gpu_smooth.smooth_file(plate, destination, **{name: True})
    # The report of an earlier run is not that of a run that was not done.
    report = tmp_path / "report.json"
    for _ in range(2):
        assert gpu_smooth.smooth_file(plate, destination, report=report)["sweeps"]
    written = report.read_bytes()
    with pytest.raises(gpu_smooth.OptionError, match="written no report"):
        gpu_smooth.smooth_file(plate, destination, report=report, dry_run=True)
    assert report.read_bytes() == written
    with pytest.raises(gpu_smooth.OptionError) as refused:
        gpu_smooth.smooth_file(plate, destination, schem="imr")
    assert "'--scheme'" in str(refused.value) and "Usage" not in str(refused.value)
    with pytest.raises(FileError) as missing:
        gpu_smooth.smooth_file(tmp_path / "none.node", destination)
    assert str(missing.value).startswith(str(tmp_path))


def test_points_whose_fixed_vertices_moved_are_written_only_if_told(tmp_path: Path) -> None:
    file = gpu_smooth.MeshFile(gmsh_file(tmp_path / "in.msh"))
    out = tmp_path / "out.msh"
    # Vertex 0 is an end of the inlet, 3 a corner, and 1 and 4 are between regions.
    for vertex in 0, 3, 4:
        points = file.points
        points[vertex] += 0.01
        with pytest.raises(MeshError, match=rf"points\[{vertex}\]: the vertex has moved.*slide=True.*moved_fixed=True") as refused:
            file.write(out, points)
        assert refused.value.vertex == vertex and not out.exists()
    points = file.points
    points[[3, 4]] += 0.01
    file.write(out, points, slide=True)
    points[0] += 0.01
    with pytest.raises(MeshError, match=r"points\[0\]: .* end of a group.*moved_fixed=True"):
        file.write(out, points, slide=True)
    file.write(out, points, moved_fixed=True)
    assert np.array_equal(gpu_smooth.MeshFile(out).points, points)
    # Rounded points of vertices that have not moved are no moves.
    file.write(out, file.points.astype(np.float32))


def test_a_triangle_mesh_is_not_written_under_another_ending_than_the_given_one(tmp_path: Path) -> None:
    file = gpu_smooth.MeshFile(MESHES / "plate.node")
    for name in "out.zzz", "out.v2", "out.smooth":
        with pytest.raises(FileError, match=rf"{name}: the ending belongs to no format.*End the name in \.node"):
            file.write(tmp_path / name, file.points)
    assert not list(tmp_path.iterdir())
    # Triangle numbers its meshes.
    for name in "out", "out.1", "other.ele":
        file.write(tmp_path / name, file.points)
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".ele"] * 3 + [".node"] * 3


def test_points_in_place_of_the_path_are_told_from_the_path(tmp_path: Path) -> None:
    file = gpu_smooth.MeshFile(gmsh_file(tmp_path / "in.msh"))
    out = tmp_path / "out.msh"
    result = gpu_smooth.run(file, engine="cpu")
    for points in file.points, file.points.tolist(), result:
        with pytest.raises(TypeError, match=rf"path: .*type {type(points).__name__}\. .*write\(path, points\)"):
            file.write(points, out)  # type: ignore[arg-type]


@pytest.mark.parametrize("slide", [False, True])
def test_a_result_is_written_as_its_points_whether_vertices_slid_or_not(tmp_path: Path, slide: bool) -> None:
    file = gpu_smooth.MeshFile(MESHES / "plate.node")
    result = gpu_smooth.run(file, slide=slide, engine="cpu")
    for given in result, pickle.loads(pickle.dumps(result)):
        file.write(tmp_path / "out.node", given)
        assert np.array_equal(gpu_smooth.MeshFile(tmp_path / "out.node").points, result.points)
    if slide:
        assert result.slid > 0
        with pytest.raises(MeshError, match="moved_fixed"):
            file.write(tmp_path / "out.node", result.points)
    file.write(tmp_path / "out.node", result.points, slide=slide)


def test_freed_lines_move_as_by_the_command_line_and_are_written(tmp_path: Path) -> None:
    points, triangles = lattice(6)
    # The lower side is uneven and ends as a group at its middle. A line ends twice inside of the square.
    points[:7, 0] = [0.0, 0.7, 1.6, 3.0, 4.2, 5.3, 6.0]
    markers = {"side": [[a, a + 1] for a in range(3)], "line": [[a, a + 1] for a in range(22, 26)]}
    path, out = tmp_path / "in.su2", tmp_path / "out.su2"
    path.write_text("\n".join([
        "NDIME= 2", f"NELEM= {len(triangles)}", *(f"5 {a} {b} {c}" for a, b, c in triangles),
        f"NPOIN= {len(points)}", *(f"{x!r} {y!r}" for x, y in points.tolist()), f"NMARK= {len(markers)}",
        *(f"MARKER_TAG= {name}\nMARKER_ELEMS= {len(edges)}\n" + "\n".join(f"3 {a} {b}" for a, b in edges)
          for name, edges in markers.items()), "",
    ]))
    file = gpu_smooth.MeshFile(path)
    line = np.arange(22, 27)
    assert {22, 26} < set(file.anchored.tolist())
    assert np.array_equal(gpu_smooth.smooth(file)[line], points[line])
    for slide in False, True:
        result = gpu_smooth.run(file, free_lines=True, slide=slide, engine="cpu")
        done = command_line(path, out, "--free-lines", "--engine", "cpu", *["--slide"] * slide)
        assert done.returncode == 0, done.stderr
        assert np.array_equal(gpu_smooth.MeshFile(out).points, result.points)
        assert (result.points[line] != points[line]).any(axis=1).all()
        assert (result.slid > 0) == slide and np.array_equal(result.points[3], points[3])
        with pytest.raises(MeshError, match="free_lines=True.*moved_fixed"):
            file.write(out, result.points, slide=slide)
        file.write(out, result.points, slide=slide, free_lines=True)
        file.write(out, pickle.loads(pickle.dumps(result)))
