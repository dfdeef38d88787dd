"""Meshes of quadrilaterals, alone and mixed with triangles, as arrays, files and meshes of other packages."""

from __future__ import annotations

import dataclasses
import pickle
import re
import sys
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import numpy.typing as npt
import pytest
import stand_ins
from conftest import Points, Triangles, command_line, lattice, mixed, squares, written
from stand_ins import DataArray, Mesh2d, Ugrid2d, UgridDataArray

import gpu_smooth
from gpu_smooth import MeshError, MeshWarning, OptionError, _picture

NONE = np.empty((0, 3), np.int64)
Cells = tuple[Triangles, Triangles]
# Options, and the same options on the command line.
SAMPLES: list[tuple[dict[str, Any], list[str]]] = [
    ({}, []),
    ({"slide": True, "corner_angle": 20}, ["--slide", "--corner-angle=20"]),
    ({"target": "keep-size"}, ["--target=keep-size"]),
    ({"target": "keep-shape", "target_of": "place"}, ["--target=keep-shape", "--target-of=place"]),
    ({"method": "relaxed"}, ["--method=relaxed"]),
    ({"scheme": "edge+imr", "max_sweeps": 4}, ["--scheme=edge+imr", "--max-sweeps=4"]),
    ({"only_bad": 1.3, "rings": 0}, ["--only-bad=1.3", "--rings=0"]),
    ({"max_move": 0.1}, ["--max-move=0.1"]),
    ({"improve_worst": True}, ["--improve-worst"]),
    ({"surface": "sphere"}, ["--surface=sphere"]),
]


@pytest.fixture(params=["alone", "mixed"])
def cells(request: pytest.FixtureRequest) -> Cells:
    return (NONE, squares(12)) if request.param == "alone" else mixed(12)


def bent() -> Points:
    """Return the points of a lattice whose boundary is uneven, so that vertices have somewhere to slide to."""
    points, _ = lattice(12)
    points[:, 0] += 0.2 * np.sin(points[:, 0]) * (points[:, 0] % 12 > 0)
    return points


@pytest.mark.parametrize(("options", "words"), SAMPLES)
@pytest.mark.filterwarnings("ignore:points. the mesh is:gpu_smooth.MeshWarning")
def test_arrays_and_files_are_smoothed_as_by_the_command_line(
    options: dict[str, Any], words: list[str], cells: Cells, tmp_path: Path
) -> None:
    points, (triangles, quadrilaterals) = bent(), cells
    source = written(tmp_path / "in.vtk", points, triangles, quadrilaterals=quadrilaterals)
    done = command_line(source, tmp_path / "out.vtk", "--quadrilaterals", "move", "--engine", "cpu", *words)
    assert done.returncode == 0, done.stderr
    expected = gpu_smooth.MeshFile(tmp_path / "out.vtk").points
    smoothed = gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals, engine="cpu", **options)
    assert np.array_equal(smoothed, expected)
    file = gpu_smooth.MeshFile(source)
    result = gpu_smooth.run(file, engine="cpu", **options)
    assert np.array_equal(result.points, expected)
    file.write(tmp_path / "own.vtk", result)
    assert (tmp_path / "own.vtk").read_bytes() == (tmp_path / "out.vtk").read_bytes()
    assert np.array_equal(gpu_smooth.smooth(file, quadrilaterals="move", engine="cpu", **options), expected)
    assert not np.array_equal(expected, points)


def test_a_gpu_moves_vertices_of_quadrilaterals(cells: Cells) -> None:
    points, (triangles, quadrilaterals) = bent(), cells
    result = gpu_smooth.run(points, triangles, quadrilaterals=quadrilaterals, engine="gpu")
    on_cpu = gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals, engine="cpu")
    assert result.engine != "cpu" and np.abs(result.points - on_cpu).max() < 0.02


def test_quadrilaterals_of_files_stay_if_told(tmp_path: Path) -> None:
    points, (triangles, quadrilaterals) = bent(), mixed(12)
    source = written(tmp_path / "in.vtk", points, triangles, quadrilaterals=quadrilaterals)
    file = gpu_smooth.MeshFile(source)
    for slide in (False, True):
        words = ["--quadrilaterals", "keep", *(["--slide"] if slide else [])]
        assert command_line(source, tmp_path / "out.vtk", *words).returncode == 0
        kept = gpu_smooth.smooth(file, quadrilaterals="keep", slide=slide)
        assert np.array_equal(kept, gpu_smooth.MeshFile(tmp_path / "out.vtk").points)
        moved = (kept != points).any(axis=1)
        assert not moved[quadrilaterals].any() and moved.sum() > 40
    for wrong in ("stay", quadrilaterals, 3):
        with pytest.raises(OptionError, match='(?s)quadrilaterals: the value is .*and must be "keep" or "move"'):
            gpu_smooth.smooth(file, quadrilaterals=wrong)


def test_files_of_quadrilaterals_alone_are_read_and_written(tmp_path: Path) -> None:
    points, quadrilaterals = bent(), squares(12)
    # A quadrilateral that lists a vertex twice, and not in a row, is no element.
    degenerate = np.array([[12, 25, 12, 24]])
    cells = np.concatenate([quadrilaterals[:11], degenerate, quadrilaterals[12:]])
    file = gpu_smooth.MeshFile(written(tmp_path / "in.vtk", points, NONE, quadrilaterals=cells))
    assert file.triangles.shape == (0, 3) and np.array_equal(file.quadrilaterals, np.delete(quadrilaterals, 11, axis=0))
    assert repr(file).endswith("169 vertices, 0 triangles, 143 quadrilaterals)")
    assert file.anchored.tolist() == [12, 24, 25] and file.regions is None
    smoothed = gpu_smooth.smooth(file)
    moved = (smoothed != points).any(axis=1)
    assert not moved[degenerate].any() and moved.sum() > 100
    file.write(tmp_path / "out.vtk", smoothed)
    smoothed[24] += 0.01
    with pytest.raises(MeshError, match=r"points\[24\]: the vertex has moved"):
        file.write(tmp_path / "out.vtk", smoothed)
    gpu_smooth.convert(tmp_path / "in.vtk", tmp_path / "out.vtu", lossy=True)
    assert len(meshio.read(tmp_path / "out.vtu").cells_dict["quad"]) == 144
    with pytest.raises(MeshError, match="no quadrilaterals of four that move"):
        gpu_smooth.smooth(file, quadrilaterals="keep")


def test_vertices_between_regions_of_quadrilaterals_stay(tmp_path: Path) -> None:
    points, (triangles, quadrilaterals) = bent(), mixed(12)
    corner = np.concatenate([triangles[:, 0], quadrilaterals[:, 0]])
    regions = np.where(corner // 13 >= 8, 7, -3)
    smoothed = gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals, regions=regions)
    row = np.arange(len(points)) // 13 == 8
    moved = (smoothed != points).any(axis=1)
    assert not moved[row].any() and moved.sum() > 100
    slid = gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals, regions=regions, slide=True)
    assert (slid != points).any(axis=1)[row].any()
    with pytest.raises(MeshError, match=r"regions: integers of shape \(216,\), 144 of triangles and 72 of quadrilaterals"):
        gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals, regions=regions[:144])
    numbers: Any = {"gmsh:physical": [regions[144:] + 4, regions[:144] + 4], "gmsh:geometrical": [regions[144:] + 4, regions[:144] + 4]}
    given = meshio.Mesh(points, [("quad", quadrilaterals), ("triangle", triangles)], cell_data=numbers)
    assert np.array_equal(gpu_smooth.smooth(given).points, smoothed)
    given.points = np.column_stack([points, 0 * points[:, 0]])
    given.write(tmp_path / "in.msh", file_format="gmsh22")
    file = gpu_smooth.MeshFile(tmp_path / "in.msh")
    assert file.regions is not None and file.regions.shape == (216,)
    assert np.array_equal(gpu_smooth.smooth(file), smoothed)
    assert np.array_equal(gpu_smooth.smooth(file.points, file.triangles, quadrilaterals=file.quadrilaterals, regions=file.regions), smoothed)
    kept = gpu_smooth.smooth(file, quadrilaterals="keep")
    assert not (kept != points).any(axis=1)[quadrilaterals].any()


def test_a_result_has_the_quadrilaterals_and_their_quality() -> None:
    points, (triangles, quadrilaterals) = bent(), mixed(12)
    # Elements of either winding are counter-clockwise in results.
    given = np.where(np.arange(72)[:, None] % 3 == 0, quadrilaterals[:, ::-1], quadrilaterals)
    smoother = gpu_smooth.Smoother(points, triangles, quadrilaterals=given)
    assert repr(smoother) == "Smoother(169 vertices, 121 free, 144 triangles, 72 quadrilaterals)"
    result = smoother.run()
    for own in (smoother.quadrilaterals, result.quadrilaterals, pickle.loads(pickle.dumps(result)).quadrilaterals):
        assert np.array_equal(np.sort(own, axis=1), np.sort(quadrilaterals, axis=1))
        edges = points[own[:, [1, 3]]] - points[own[:, :1]]
        assert (np.linalg.det(edges) > 0).all()
    for quality, at in ((result.quality_before, points), (result.quality_after, result.points)):
        values = gpu_smooth.quality(at, triangles, "imr", quadrilaterals=quadrilaterals)
        assert values.shape == (216,)
        np.testing.assert_allclose(quality.f("imr"), np.mean(values**2), rtol=1e-12)
        angles = gpu_smooth.quality(at, triangles, "min-angle", quadrilaterals=quadrilaterals)
        np.testing.assert_allclose(quality.min_angle, angles.min(), rtol=1e-9)
        assert pickle.loads(pickle.dumps(quality)).worst_element == quality.worst_element
    assert result.quality_after.f("imr") < result.quality_before.f("imr")
    of_triangles = gpu_smooth.quality(points, triangles, "schism-skewness", quadrilaterals=quadrilaterals)
    assert np.isfinite(of_triangles[:144]).all() and np.isnan(of_triangles[144:]).all()
    moved = points * 2.0
    again = smoother.run(moved)
    np.testing.assert_allclose(again.points, 2.0 * result.points, atol=0.05)


def test_remarks_are_on_elements() -> None:
    points, (triangles, quadrilaterals) = bent(), mixed(12)
    result = gpu_smooth.run(points, triangles, quadrilaterals=quadrilaterals, only_bad=1.2, improve_worst=True)
    first, last = result.remarks
    assert re.match(r"only_bad: \d\d elements are above an inverse mean ratio of 1.2", first)
    assert last.startswith("improve_worst: the worst imr of movable elements was improved from")


def test_the_worst_element_is_named_with_its_kind() -> None:
    # A triangle on a quadrilateral.
    points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0.5, 1.8]])
    triangles, quadrilaterals = [[3, 2, 4]], [[0, 1, 2, 3]]
    for place, worst in ((4, ("triangle", 0)), (0, ("quadrilateral", 0))):
        own = points.copy()
        own[place] += [0.0, 0.6]
        compared = gpu_smooth.compare(points, own, triangles, quadrilaterals=quadrilaterals)
        assert compared.vertices_moved == 1 and compared.quality_after.worst_element == worst
        # Half a square is as long as wide beside its right angle.
        assert compared.quality_before.worst_imr < compared.quality_after.worst_imr


def test_concave_quadrilaterals_are_named_and_untangled() -> None:
    points, quadrilaterals = bent(), squares(12)
    points[80] += [0.7, 0.7]
    with pytest.raises(MeshError, match=r"^quadrilaterals\[\d+\]: quadrilateral \d+ is concave at vertex \d+, one of") as refused:
        gpu_smooth.smooth(points, NONE, quadrilaterals=quadrilaterals)
    assert refused.value.triangles == () and len(refused.value.quadrilaterals) >= 1
    bad = gpu_smooth.quality(points, NONE, "scaled-jacobian", quadrilaterals=quadrilaterals) <= 0
    assert refused.value.quadrilaterals == tuple(np.flatnonzero(bad).tolist())
    untangled = gpu_smooth.untangle(points, NONE, quadrilaterals=quadrilaterals)
    assert (gpu_smooth.quality(untangled, [], "scaled-jacobian", quadrilaterals=quadrilaterals) > 0).all()
    smoothed = gpu_smooth.smooth(points, [], quadrilaterals=quadrilaterals, untangle=True)
    assert (gpu_smooth.quality(smoothed, [], "scaled-jacobian", quadrilaterals=quadrilaterals) > 0.8).all()
    with pytest.raises(MeshError, match=r"quadrilaterals: quadrilateral \d+ at vertex \d+ and \d+ more cannot be untangled") as stuck:
        gpu_smooth.untangle(points, NONE, quadrilaterals=quadrilaterals, fixed=np.arange(169))
    assert stuck.value.quadrilaterals == refused.value.quadrilaterals


@pytest.mark.parametrize(("quadrilaterals", "kind", "message"), [
    (squares(12)[:, :3], MeshError, r"quadrilaterals: integers of shape \(k, 4\) are needed, but the shape is \(144, 3\)"),
    (squares(12).astype(float), MeshError, r"quadrilaterals: .*\.astype\(int\)"),
    (squares(12) + 60, MeshError, r"quadrilaterals\[\d+, \d\] is 169, but points has 169 rows"),
    ([[0, 1, 14, 0]], MeshError, r"quadrilaterals\[0\]: quadrilateral 0 uses vertex 0 twice. Remove the quadrilateral"),
    (np.concatenate([squares(12), squares(12)[:1], squares(12)[:1]]), MeshError, "quadrilaterals: the edge between .* Remove quadrilaterals"),
    ("keep", OptionError, r"quadrilaterals: the value is 'keep', and must be integers of shape \(k, 4\)"),
    ([], MeshError, "triangles: the mesh has no triangles and no quadrilaterals. Pass"),
    (None, MeshError, "triangles: the mesh has no triangles and no quadrilaterals. Pass"),
])
def test_wrong_quadrilaterals_are_refused(quadrilaterals: Any, kind: type[Exception], message: str) -> None:
    functions: list[Any] = [gpu_smooth.smooth, gpu_smooth.run, gpu_smooth.quality, gpu_smooth.untangle]
    for function in functions:
        with pytest.raises(kind, match=message):
            function(bent(), NONE, quadrilaterals=quadrilaterals)


def test_a_vertex_between_two_elements_is_refused() -> None:
    points = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2], [1, 1]])
    with pytest.raises(MeshError, match=r"points\[4\]: vertex 4 is a doublet") as refused:
        gpu_smooth.smooth(points, [], quadrilaterals=[[0, 1, 2, 4], [0, 4, 2, 3]])
    assert refused.value.vertex == 4 and refused.value.quadrilaterals == (0, 1)


def test_data_are_bilinear_in_quadrilaterals() -> None:
    points, (triangles, quadrilaterals) = bent(), mixed(12)
    moved = gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals)
    taken = gpu_smooth.interpolate(
        points, triangles, moved, 2 * points[:, 0] - points[:, 1], quadrilaterals=quadrilaterals
    )
    np.testing.assert_allclose(taken, 2 * moved[:, 0] - moved[:, 1], atol=1e-12)
    # A product of coordinates is bilinear in a square.
    square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    at = square.copy()
    at[1] = [1.5, 0.5]
    taken = gpu_smooth.interpolate(square, [], at, square[:, 0] * square[:, 1], quadrilaterals=[[1, 2, 3, 0]])
    assert taken.tolist() == [0.0, 0.75, 4.0, 0.0]
    square[2] = [-2.0, -2.0]
    with pytest.raises(MeshError, match=r"^quadrilaterals\[0\]: quadrilateral 0 is concave at vertex [0-3]\.") as refused:
        gpu_smooth.interpolate(square, [], at, [0, 1, 0, 7], quadrilaterals=[[0, 1, 2, 3]])
    assert refused.value.quadrilaterals == (0,) and refused.value.triangles == ()


def test_quadrilaterals_across_the_date_line_move() -> None:
    points, (triangles, quadrilaterals) = bent(), mixed(12)
    degrees = points * [0.2, 0.2] + [178.9, 1.0]
    expected = gpu_smooth.smooth(degrees, triangles, quadrilaterals=quadrilaterals, surface="sphere")
    across = degrees[:, 0] > 180
    degrees[across, 0] -= 360
    given = meshio.Mesh(degrees, [("triangle", triangles), ("quad", quadrilaterals)])
    moved = gpu_smooth.smooth(given, surface="sphere").points
    moved = np.where(moved[:, :1] < 0, moved + [360, 0], moved)
    np.testing.assert_allclose(moved, expected, atol=1e-6)
    assert (moved != degrees).any(axis=1)[quadrilaterals].sum() > 40


def test_meshes_of_meshio_move_their_quadrilaterals(cells: Cells) -> None:
    points, (triangles, quadrilaterals) = bent(), cells
    # The vertices of a quadrilateral that lists one twice, and of a polygon, stay.
    other = [("quad", np.array([[30, 31, 31, 44]])), ("polygon", np.array([[80, 81, 94, 93, 92]]))]
    given = meshio.Mesh(points, [("quad", quadrilaterals), ("triangle", triangles), *other])
    smoothed = gpu_smooth.smooth(given)
    held = [30, 31, 44, 80, 81, 94, 93, 92]
    expected = gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals, fixed=held)
    assert np.array_equal(smoothed.points, expected) and (expected != points).any(axis=1).sum() > 100
    values = gpu_smooth.quality(given, measure="shape")
    assert np.array_equal(values, gpu_smooth.quality(points, triangles, "shape", quadrilaterals=quadrilaterals))
    with pytest.raises(MeshError, match="quadrilaterals: a mesh in place of the arrays has its own"):
        gpu_smooth.quality(given, quadrilaterals=quadrilaterals)
    if len(triangles):
        kept = gpu_smooth.smooth(given, quadrilaterals="keep").points
        assert np.array_equal(kept, gpu_smooth.smooth(points, triangles, fixed=[*quadrilaterals.ravel(), *held]))
    # Sets of points end on sides of quadrilaterals too.
    given.point_sets = {"inlet": np.arange(9, 13)}
    slid = gpu_smooth.smooth(given, slide=True).points
    free = gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals, fixed=held, slide=True)
    assert np.array_equal(slid[9], points[9]) and not np.array_equal(free[9], points[9])


def test_faces_of_meshkernel_and_xugrid_move(cells: Cells, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "meshkernel", stand_ins.meshkernel)
    monkeypatch.setitem(sys.modules, "xugrid", stand_ins.xugrid)
    points, (triangles, quadrilaterals) = bent(), cells
    expected = gpu_smooth.smooth(points, triangles, quadrilaterals=quadrilaterals)
    x, y = points.T
    nodes = np.concatenate([quadrilaterals.ravel(), triangles.ravel()]).astype(np.int32)
    sizes = np.repeat(np.array([4, 3], np.int32), [len(quadrilaterals), len(triangles)])
    smoothed = gpu_smooth.smooth(Mesh2d(x, y, np.empty(0, np.int32), nodes, sizes))
    assert np.array_equal(np.column_stack([smoothed.node_x, smoothed.node_y]), expected)
    faces = np.concatenate([quadrilaterals, np.pad(triangles, ((0, 0), (0, 1)), constant_values=-1)])
    grid = Ugrid2d(x, y, faces, False)
    assert np.array_equal(gpu_smooth.smooth(grid).node_coordinates, expected)
    depths = DataArray(2 * x - y, "mesh2d_nNodes", name="depth")
    moved = gpu_smooth.smooth(UgridDataArray(depths, grid))
    np.testing.assert_allclose(moved.obj.values, 2 * expected[:, 0] - expected[:, 1], atol=1e-12)
    x, y = (points + 0.8 * (np.arange(169) == 84)[:, None]).T
    if not len(triangles):
        with pytest.raises(MeshError, match=r"data of nodes \(depth\) cannot be interpolated, as \d+ quadrilaterals are not convex"):
            gpu_smooth.smooth(UgridDataArray(depths, Ugrid2d(x, y, faces, False)), untangle=True)


@dataclasses.dataclass(frozen=True)
class MeshQuad1:
    """A mesh with the attributes of a `skfem.MeshQuad1`."""

    doflocs: Points
    t: Triangles
    boundaries: None = None
    subdomains: dict[str, npt.NDArray[np.int64]] | None = None

    @property
    def p(self) -> Points:
        return self.doflocs


class MeshQuad2(MeshQuad1):
    """A mesh of curved quadrilaterals."""


for kind in (MeshQuad1, MeshQuad2):
    kind.__module__ = "skfem.mesh.mesh_quad_1"


def test_quadrilaterals_of_scikit_fem_move() -> None:
    points, quadrilaterals = bent(), squares(12)
    upper = np.flatnonzero(quadrilaterals[:, 0] // 13 >= 8)
    given = MeshQuad1(points.T, quadrilaterals.T, subdomains={"upper": upper})
    smoothed = gpu_smooth.smooth(given)
    regions = np.isin(np.arange(144), upper).astype(int)
    expected = gpu_smooth.smooth(points, NONE, quadrilaterals=quadrilaterals, regions=regions)
    assert type(smoothed) is MeshQuad1 and np.array_equal(smoothed.p.T, expected)
    with pytest.raises(MeshError, match="MeshQuad2 is not accepted. Pass a MeshTri or MeshQuad of linear elements"):
        gpu_smooth.smooth(MeshQuad2(points.T, quadrilaterals.T))


def test_quadrilaterals_of_scikit_fem_itself_move() -> None:
    skfem = pytest.importorskip("skfem")
    given = skfem.MeshQuad().refined(3).with_subdomains({"lower": lambda x: x[1] < 0.5})
    is_inner = ((given.p > 0) & (given.p < 1) & (given.p[1] != 0.5)).all(axis=0)
    by = 0.03 * is_inner * np.random.default_rng(1).uniform(-1, 1, given.p.shape)
    given = dataclasses.replace(given, doflocs=given.p + by)
    result = gpu_smooth.run(given)
    moved = (result.mesh.p != given.p).any(axis=0)
    assert type(result.mesh) is type(given) and np.array_equal(moved, is_inner)
    assert result.quality_after.f() < 1.001 < result.quality_before.f()
    with pytest.raises(MeshError, match="MeshQuad2 is not accepted"):
        gpu_smooth.quality(skfem.MeshQuad2())


def test_pictures_show_quadrilaterals(cells: Cells) -> None:
    points, (triangles, quadrilaterals) = bent(), cells
    result = gpu_smooth.run(points, triangles, quadrilaterals=quadrilaterals)
    subject = result._subject()
    picture = _picture.svg(subject.states["after"], subject)
    assert picture.count("M") == len(triangles) + len(quadrilaterals) and picture.count("L") == 2 * len(triangles) + 3 * len(quadrilaterals)
    assert "#e6194b" not in picture
    concave = subject.states["after"].copy()
    concave[80] += [0.9, 0.9]
    assert "#e6194b" in _picture.svg(concave, subject)
    assert "Triangles and quadrilaterals by shape" in result._repr_html_()


@pytest.mark.heavy
def test_matplotlib_draws_quadrilaterals(cells: Cells) -> None:
    import matplotlib

    matplotlib.use("agg")
    from matplotlib import colors, pyplot

    points, (triangles, quadrilaterals) = bent(), cells
    result = gpu_smooth.run(points, triangles, quadrilaterals=quadrilaterals)
    figure = result.plot(measure="min-angle", vmin=20)
    for axes, at in zip(figure.axes, (points, result.points)):
        drawn = axes.collections[0]
        angles = gpu_smooth.quality(at, triangles, "min-angle", quadrilaterals=quadrilaterals)
        np.testing.assert_allclose(drawn.get_array(), angles)
        assert drawn.norm.vmin == 20 and len(drawn.get_paths()) == len(triangles) + len(quadrilaterals)
        assert axes.get_xlim()[0] <= 0 and axes.get_xlim()[1] >= 12
    with_norm = result.plot("after", norm=colors.LogNorm(10, 90))
    assert with_norm.axes[0].collections[0].norm.vmax == 90
    with pytest.raises(OptionError, match="measure: quadrilaterals have no schism-skewness"):
        result.plot(measure="schism-skewness")
    pyplot.close("all")
