"""Examples, pictures and the README."""

from __future__ import annotations

import os
import pickle
import re
import subprocess
import sys
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from conftest import Points, Triangles, across_date_line, mixed, polar_cap

import gpu_smooth
from gpu_smooth import _native, _picture

EXAMPLES = Path(__file__).parents[1] / "examples"
Mesh = tuple[Points, Triangles]


def output(name: str, *words: str | Path, **variables: str) -> str:
    """Run an example, and return what it prints."""
    command = [sys.executable, "-P" if sys.version_info >= (3, 11) else "-B", str(EXAMPLES / name)]
    done = subprocess.run(
        [*command, *map(str, words)], capture_output=True, text=True, check=False, env={**os.environ, **variables}
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.heavy
@pytest.mark.parametrize("name", sorted(path.name for path in EXAMPLES.glob("*.py")))
def test_help_is_printed_in_place_of_a_run(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert output(name, "--help").startswith("usage: ")
    assert not list(tmp_path.iterdir())


def test_optimesh_is_replaced() -> None:
    before, after = map(float, re.findall(r"least angle (\S+) -> (\S+) ", output("replace_optimesh.py"))[0])
    assert before < 20 < 30 < after


def test_tasks_of_a_job_array_share_the_meshes(tmp_path: Path, plate: Path) -> None:
    source = tmp_path / "in"
    source.mkdir()
    for k in range(5):
        gpu_smooth.convert(plate, source / f"mesh{k}.vtk")
    for task in ("3", "4"):
        output(
            "slurm_array.py", source, tmp_path / "out",
            SLURM_ARRAY_TASK_ID=task, SLURM_ARRAY_TASK_MIN="3", SLURM_ARRAY_TASK_COUNT="2",
        )
        expected = {"3": ["mesh0.vtk", "mesh2.vtk", "mesh4.vtk"], "4": [f"mesh{k}.vtk" for k in range(5)]}[task]
        assert sorted(path.name for path in (tmp_path / "out").iterdir()) == expected


def test_a_mesh_of_several_files_is_smoothed_by_one_task(tmp_path: Path, plate: Path) -> None:
    source = tmp_path / "in"
    source.mkdir()
    for name in "a", "b.1":
        for ending in "node", "ele":
            (source / f"{name}.{ending}").write_bytes(plate.with_suffix(f".{ending}").read_bytes())
    (source / "a.poly").write_text("0 2 0 0\n0 0\n0\n")
    gpu_smooth.convert(plate, source / "c.vtk")
    printed = [
        output(
            "slurm_array.py", source, tmp_path / "out",
            SLURM_ARRAY_TASK_ID=task, SLURM_ARRAY_TASK_MIN="0", SLURM_ARRAY_TASK_MAX="2", SLURM_ARRAY_TASK_COUNT="2",
            SLURM_ARRAY_TASK_STEP="2",
        )
        for task in ("0", "2")
    ]
    assert [re.findall(r"^(\S+): ", text, re.MULTILINE) for text in printed] == [["a.node", "c.vtk"], ["b.1.node"]]
    command = [sys.executable, str(EXAMPLES / "slurm_array.py"), str(source), str(tmp_path / "none")]
    # --array=0,1,5
    irregular = {"ID": "1", "MIN": "0", "MAX": "5", "COUNT": "3", "STEP": "1"}
    names = {f"SLURM_ARRAY_TASK_{name}": value for name, value in irregular.items()}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, **names})
    assert done.returncode == 1 and "equal steps" in done.stderr


@pytest.mark.heavy
def test_a_thousand_meshes_are_smoothed_through_dask() -> None:
    assert re.match(r"1000 meshes, least angle (\d+)", output("many_meshes_dask.py", "--side", "12"))


@pytest.mark.heavy
def test_a_grid_for_delft3d_fm_is_made_orthogonal(tmp_path: Path) -> None:
    import xugrid

    printed = output("delft3d_fm.py", tmp_path / "grid_net.nc")
    count, before, after = map(int, re.findall(r"(\d+) triangles, refused edges (\d+) -> (\d+)", printed)[0])
    assert after <= before // 5
    assert xugrid.open_dataset(tmp_path / "grid_net.nc").ugrid.grid.n_face == count


@pytest.mark.heavy
def test_a_coast_of_ocsmesh_is_made_orthogonal(tmp_path: Path) -> None:
    printed = output("ocsmesh_coast.py", tmp_path / "coast.2dm")
    counts = re.findall(r"(\d+) triangles, oblique edges at (\d+) -> (\d+), obtuse (\d+) -> (\d+)", printed)[0]
    count, before, after, obtuse_before, obtuse_after = map(int, counts)
    assert count > 4000 and after <= before // 3 and obtuse_after <= obtuse_before // 2
    file = gpu_smooth.MeshFile(tmp_path / "coast.2dm")
    assert len(file.triangles) == count and file.data("z").min() < -50


@pytest.mark.heavy
@pytest.mark.parametrize("name", ["coast", "airfoil", "two_materials"])
def test_the_gallery_draws(name: str, tmp_path: Path) -> None:
    printed = output(f"gallery_{name}.py", tmp_path / "picture.png", MPLBACKEND="agg")
    before, after = map(float, re.findall(r"f \S+ (\S+) -> (\S+),", printed)[0])
    assert after < before and "inverted 0" in printed
    assert (tmp_path / "picture.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.heavy
def test_a_result_is_plotted(mesh: Mesh) -> None:
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    result = gpu_smooth.run(*mesh)
    figure = result.plot()
    assert [axes.get_title() for axes in figure.axes[:2]] == ["before", "after"]
    # Bad triangles are dark by each measure, and angles have their unit.
    for measure, label, is_low_dark in (("imr", "imr", False), ("min_angle", "min_angle (°)", True), ("shape", "shape", True)):
        mesh_axes, bar = result.plot("after", measure).axes
        assert mesh_axes.get_title() == "after" and bar.get_ylabel() == label
        dark, light = (colors(k)[:3] for colors in [mesh_axes.collections[0].cmap] for k in (0.0, 1.0))
        assert (sum(dark) < sum(light)) == is_low_dark, measure
    # By default and by a range, both pictures have the same colors, of which the bar states the ends.
    ranges: list[tuple[dict[str, Any], float, float]] = [({}, 0.5, 1.0), ({"measure": "imr", "picture_range": (1, 4)}, 1.0, 4.0)]
    for options, low, high in ranges:
        before, after, bar = result.plot(**options).axes
        assert [(axes.collections[0].norm.vmin, axes.collections[0].norm.vmax) for axes in (before, after)] == [(low, high)] * 2
        assert bar.get_ylim() == (low, high) and bar.get_ylabel() == options.get("measure", "shape")
    for picture_range, problem in (
        ((1, 0.5), "picture_range: the first value must be below the second"),
        ((0.5, 1.5), "picture_range: both values of shape must be from 0 to 1"),
        ((0.5,), "picture_range: the value is (0.5,), and must be two numbers"),
    ):
        with pytest.raises(gpu_smooth.OptionError, match=re.escape(problem)):
            result.plot(picture_range=picture_range)  # type: ignore[arg-type]
    with pytest.raises(gpu_smooth.OptionError, match="which: the value is 'then'"):
        result.plot("then")  # type: ignore[arg-type]
    pyplot.close("all")


@pytest.mark.heavy
def test_a_result_is_shown(mesh: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    shown: list[Any] = []
    monkeypatch.setattr(pyplot, "show", lambda: shown.extend(pyplot.gcf().axes))
    gpu_smooth.run(*mesh).show(measure="min-angle", picture_range=(20, 60))
    assert [axes.get_title() for axes in shown[:2]] == ["before", "after"]
    assert shown[0].collections[0].norm.vmin == 20
    pyplot.close("all")


@pytest.mark.heavy
def test_a_picture_shows_the_mesh_alone_and_takes_a_norm(mesh: Mesh) -> None:
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import colors, pyplot

    points, triangles = mesh
    # A vertex without a triangle, as the center of an arc in gmsh may be.
    result = gpu_smooth.run(np.concatenate([[[1e5, 1e5]], points]), triangles + 1)
    figure = result.plot("after", norm=colors.LogNorm(1, 2))
    assert figure.axes[0].get_xlim()[1] < 13 and figure.axes[0].collections[0].norm.vmax == 2
    pyplot.close("all")


def test_pictures_without_matplotlib_name_the_remedy(mesh: Mesh, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(ImportError, match="pip install matplotlib"):
        gpu_smooth.run(*mesh).show()


def test_a_notebook_shows_the_mesh_before_and_after(mesh: Mesh) -> None:
    points, triangles = mesh
    html = gpu_smooth.run(points, triangles)._repr_html_()
    # The picture is well-formed XML.
    root = ElementTree.fromstring(html)
    pictures = root.findall(".//{http://www.w3.org/2000/svg}svg")
    assert len(pictures) == 2
    for picture in pictures:
        paths = "".join(path.get("d") or "" for path in picture)
        assert paths.count("M") == len(triangles)
        numbers = np.array(re.findall(r"[-\d.]+", paths), float)
        assert numbers.min() == 0 and numbers.max() == 360
    assert "converged" in html
    # The legend states the range, and the colors are those of the command line.
    assert "Triangles by shape: dark blue is ≤ 0.5, yellow is 1" in html
    colors = {path.get("fill") for picture in pictures for path in picture}
    assert "#fde725" in colors and colors <= {*_native.color_scale("shape", None)["colors"]}


def test_pictures_of_a_mesh_on_the_sphere_have_the_values_on_the_sphere(mesh: Mesh) -> None:
    points, _ = mesh
    triangles, quadrilaterals = mixed(12)
    for given in (*across_date_line(points), across_date_line(points)[1].astype(np.float32)):
        result = gpu_smooth.run(given, triangles, quadrilaterals=quadrilaterals, surface="sphere", max_sweeps=2)
        subject = result._subject()
        for state, own in ("before", result.points_before), ("after", result.points):
            expected = gpu_smooth.quality(own, triangles, "shape", quadrilaterals=quadrilaterals, surface="sphere")
            np.testing.assert_allclose(_picture._judged_values(subject.states[state], subject, "shape"), expected, rtol=1e-9)
            in_plane = gpu_smooth.quality(own, triangles, "shape", quadrilaterals=quadrilaterals, surface="plane")
            assert np.abs(in_plane[:9] - expected[:9]).max() > 0.1
            # No element is drawn across the whole map.
            corners = subject.states[state][subject.triangles]
            assert np.ptp(corners[:, :, 0], axis=1).max() < 1.0


def test_elements_at_a_pole_list_the_vertices_of_the_points_and_are_drawn_beside_each_other() -> None:
    points, triangles = polar_cap()
    result = gpu_smooth.run(points, triangles, surface="sphere")
    assert result.sweeps > 0 and not np.array_equal(result.points, points)
    smoother = gpu_smooth.Smoother(points, triangles, surface="sphere")
    for listed in result.triangles, smoother.triangles:
        assert np.array_equal(np.sort(listed, axis=1), np.sort(triangles, axis=1))
    assert result.points[result.triangles].shape == (len(triangles), 3, 2)
    subject = result._subject()
    for state, own in ("before", points), ("after", result.points):
        corners = subject.states[state][subject.triangles]
        assert np.ptp(corners[:, :, 0], axis=1).max() < 60.0
        expected = gpu_smooth.quality(own, triangles, "min-angle", surface="sphere")
        found = _picture._judged_values(subject.states[state], subject, "min-angle")
        np.testing.assert_allclose(found, expected, rtol=1e-9)
    html = result._repr_html_()
    assert html.count("M") == 2 * len(triangles) + html.count("Min")
    again = pickle.loads(pickle.dumps(result))
    assert again._repr_html_() == html and np.array_equal(again.triangles, result.triangles)

    # Pairs of triangles as quadrilaterals.
    cells = np.stack([triangles[12:24, 0], *triangles[12:24, 1:].T, triangles[48:60, 2]], axis=1)
    left = np.delete(triangles, np.r_[12:24, 48:60], axis=0)
    result = gpu_smooth.run(points, left, quadrilaterals=cells, surface="sphere")
    assert np.array_equal(np.sort(result.quadrilaterals, axis=1), np.sort(cells, axis=1))
    assert "svg" in result._repr_html_()


@pytest.mark.heavy
def test_a_mesh_at_a_pole_is_plotted() -> None:
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import pyplot

    points, triangles = polar_cap()
    result = gpu_smooth.run(points, triangles, surface="sphere")
    mesh_axes, bar = result.plot("after", " Min_Angle ").axes
    assert bar.get_ylabel() == "Min_Angle (°)"
    expected = gpu_smooth.quality(result.points, triangles, "min-angle", surface="sphere")
    np.testing.assert_allclose(mesh_axes.collections[0].get_array(), expected, rtol=1e-9)
    west, east = mesh_axes.get_xlim()
    assert 360.0 <= east - west < 480.0
    pyplot.close("all")


def test_inverted_triangles_of_a_picture_are_red() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.5, 0.5]])
    triangles = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    subject = _picture.Subject({}, triangles, np.empty((0, 4), np.int64), ("x", "y"), "plane")
    assert _picture.svg(points, subject).count('fill="#e6194b"') == 1
    points[4] = [0.5, 0.5]
    assert "#e6194b" not in _picture.svg(points, subject)
