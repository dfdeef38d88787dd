"""`smooth`, `run` and `Smoother` on arrays."""

from __future__ import annotations

import inspect
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Points, Triangles, alternating, command_line, lattice, written

import gpu_smooth
from gpu_smooth import MeshError, MeshWarning, OptionError, _native

Mesh = tuple[Points, Triangles]
METRICS = [metric.name for metric in gpu_smooth.metrics()]


@pytest.mark.parametrize("engine", ["cpu", "gpu"])
@pytest.mark.parametrize("scheme", [*METRICS, "edge+imr", "imr+rms+imr"])
def test_points_have_the_bits_of_the_command_line(
    scheme: str, engine: Any, mesh: Mesh, tmp_path: Path
) -> None:
    points, triangles = mesh
    source, destination = written(tmp_path / "in.vtk", points, triangles), tmp_path / "out.vtk"
    done = command_line(source, destination, "--scheme", scheme, "--engine", engine)
    assert done.returncode == 0, done.stderr
    smoothed = gpu_smooth.smooth(points, triangles, scheme=scheme, engine=engine)
    assert np.array_equal(smoothed, gpu_smooth.MeshFile(destination).points)
    assert not np.array_equal(smoothed, points)


# Options, and the same options on the command line.
SAMPLES: list[tuple[dict[str, Any], list[str]]] = [
    ({"target": "keep-size"}, ["--target", "keep-size"]),
    ({"target": "keep_shape", "target_rings": 4}, ["--target=keep-shape", "--target-rings=4"]),
    ({"keep_layers": "none"}, ["--keep-layers", "none"]),
    ({"target": "keep-shape", "target_of": "place"}, ["--target=keep-shape", "--target-of=place"]),
    ({"method": "relaxed", "omega": 1.3}, ["--method", "relaxed", "--omega", "1.3"]),
    ({"inner": 3, "tolerance": 1e-3}, ["--inner", "3", "--tolerance", "1e-3"]),
    ({"method": "multilevel", "max_sweeps": 3}, ["--method=multilevel", "--max-sweeps=3"]),
    ({"fraction": 0.5, "desired": 1.4}, ["--fraction", "0.5", "--desired", "1.4"]),
    ({"desired": "auto"}, ["--desired", "auto"]),
    ({"guard": "worst", "scheme": "rms"}, ["--guard", "worst", "--scheme", "rms"]),
    ({"max_move": 0.1}, ["--max-move", "0.1"]),
    ({"keep_altitude": True}, ["--keep-altitude"]),
    ({"improve_worst": "min-angle"}, ["--improve-worst=min-angle"]),
    ({"improve_worst": True}, ["--improve-worst"]),
    ({"free_lines": True, "slide": True}, ["--free-lines", "--slide"]),
    ({"only_bad": 1.6, "rings": 0}, ["--only-bad", "1.6", "--rings", "0"]),
    ({"slide": True, "corner_angle": 20}, ["--slide", "--corner-angle", "20"]),
    ({"surface": "sphere"}, ["--surface", "sphere"]),
    ({"surface": "sphere", "max_move": 0.2}, ["--surface", "sphere", "--max-move", "0.2"]),
    ({"scheme": "edge", "edge_norm": "fixed"}, ["--scheme=edge", "--edge-norm=fixed"]),
    ({"derivatives": "finite-difference"}, ["--derivatives", "finite-difference"]),
    ({"tolerance": 1e-2, "history": "all"}, ["--tolerance", "1e-2"]),
    ({"slide": True, "hausdorff": 0.01}, ["--slide", "--hausdorff", "0.01"]),
]


def test_each_option_of_the_table_has_a_sample() -> None:
    without = {"engine", "adapter", "time_limit", "checkpoint_every", "z", "untangle"}
    names = {option["name"] for option in _native.options()}
    assert names - without == {name for options, _ in SAMPLES for name in options} & names


@pytest.mark.parametrize(("options", "words"), SAMPLES)
@pytest.mark.filterwarnings("ignore:points. the mesh is:gpu_smooth.MeshWarning")
def test_options_act_as_those_of_the_command_line(
    options: dict[str, Any], words: list[str], mesh: Mesh, tmp_path: Path
) -> None:
    points, triangles = mesh
    if "keep_altitude" in options:
        # A run would lower the least altitude of an even mesh.
        points, triangles = lattice(12, by=0.0)
    if "keep_layers" in options:
        # Rows at the lower side grow by 1.4.
        points, triangles = lattice(12, by=0.0)
        points[:, 1] = 12.0 * (1.4 ** points[:, 1] - 1.0) / (1.4**12 - 1.0)
    # The boundary is uneven, so that vertices have somewhere to slide to.
    points[:, 0] += 0.2 * np.sin(points[:, 0]) * (points[:, 0] % 12 > 0)
    lines = np.empty((0, 2), np.int64)
    if "free_lines" in options:
        lines = np.concatenate([triangles[:, :2], triangles[:, 1:], triangles[:, ::2]])
        with pytest.raises(MeshError, match="free_lines=True if lines hold them"):
            gpu_smooth.smooth(points, triangles, lines=lines)
        options = {**options, "lines": lines}
    source, destination = written(tmp_path / "in.vtk", points, triangles, lines), tmp_path / "out.vtk"
    done = command_line(source, destination, *words)
    assert done.returncode == 0, done.stderr
    smoothed = gpu_smooth.smooth(points, triangles, **options)
    assert np.array_equal(smoothed, gpu_smooth.MeshFile(destination).points)
    assert not np.array_equal(smoothed, gpu_smooth.smooth(points, triangles))


@pytest.mark.filterwarnings("ignore:points. the mesh is:gpu_smooth.MeshWarning")
def test_layers_stay_above_the_walls_that_are_passed() -> None:
    points, triangles = lattice(12, by=0.0)
    points[:, 1] = 12.0 * (1.4 ** points[:, 1] - 1.0) / (1.4**12 - 1.0)
    bottom, top = (np.flatnonzero(points[:, 1] == y) for y in (points[0, 1], points[-1, 1]))
    row = np.arange(len(points)) // 13
    for walls, kept in ((bottom, row <= 2), (top, row >= 10), (row == 0, row <= 2)):
        smoothed = gpu_smooth.smooth(points, triangles, keep_layers=("rows=2", walls))
        moved = (smoothed != points).any(axis=1)
        assert not moved[kept].any() and moved[~kept].sum() > 60
    with pytest.raises(gpu_smooth.OptionError, match="keep_layers"):
        gpu_smooth.smooth(points, triangles, keep_layers=("none", bottom))
    with pytest.raises(gpu_smooth.MeshError, match="keep_layers"):
        gpu_smooth.smooth(points, triangles, keep_layers=("rows=2", [999]))
    with pytest.warns(MeshWarning, match="every free vertex is in a boundary layer"):
        smoothed = gpu_smooth.smooth(points, triangles, keep_layers=("rows=12", bottom))
    assert np.array_equal(smoothed, points)
    even, triangles = lattice(12)
    with pytest.warns(MeshWarning, match="no wall has such a layer"):
        gpu_smooth.smooth(even, triangles, keep_layers="rows=2")


def test_every_option_is_one_of_the_command_line() -> None:
    known = command_line("--help").stdout
    only_here = {"fixed", "lines", "regions", "on_sweep", "resume"}
    from gpu_smooth import _native
    from gpu_smooth._options import MeshOptions, RunOptions

    of_mesh, of_run = _native.mesh_options(), _native.run_options()
    assert set(of_mesh) == set(MeshOptions.__annotations__)
    assert set(of_run) == set(RunOptions.__annotations__)
    for name in {*of_mesh, *of_run} - only_here:
        assert f"--{name.replace('_', '-')}" in known, name
        assert f"\n{name} : " in str(inspect.getdoc(gpu_smooth.smooth)), name
    assert only_here <= {*of_mesh, *of_run}


def test_the_form_of_points_is_kept(mesh: Mesh) -> None:
    points, triangles = mesh
    smoothed = gpu_smooth.smooth(points, triangles)
    depths = np.arange(float(len(points)))
    in_space = gpu_smooth.smooth(np.column_stack([points, depths]), triangles, z="data")
    assert in_space.dtype == np.float64
    assert np.array_equal(in_space, np.column_stack([smoothed, depths]))
    single = np.column_stack([points, depths]).astype(np.float32)
    of_single = gpu_smooth.smooth(single, triangles, z="data")
    assert of_single.dtype == np.float32 and np.array_equal(of_single[:, 2], single[:, 2])
    assert np.abs(of_single[:, :2] - smoothed).max() < 1e-3
    swapped = single.astype(single.dtype.newbyteorder())
    of_swapped = gpu_smooth.smooth(swapped, triangles, z="data")
    assert of_swapped.dtype == np.float32 and np.array_equal(of_swapped, of_single)
    for other in points.astype(np.float16), (100.0 * points).astype(np.int32):
        assert gpu_smooth.smooth(other, triangles).dtype == np.float64


def test_points_and_triangles_may_have_any_layout_and_integer_type(mesh: Mesh) -> None:
    points, triangles = mesh
    before = points.copy()
    smoothed = gpu_smooth.smooth(points, triangles)
    assert np.array_equal(points, before), "arguments are not changed"
    wide = np.zeros((len(points), 7))
    wide[:, 1:3] = points
    frozen = points.copy()
    frozen.flags.writeable = False
    raw = np.zeros(points.nbytes + 1, np.uint8)
    unaligned = raw[1:].view(np.float64).reshape(points.shape)
    unaligned[:] = points
    for other in (
        np.asfortranarray(points), points[::-1][::-1], wide[:, 1:3], frozen, unaligned, points.tolist(),
        points.astype(">f8"),
    ):
        assert np.array_equal(gpu_smooth.smooth(other, triangles), smoothed)
    for kind in "bhilqBHILQ":
        if np.iinfo(kind).max >= len(points):
            assert np.array_equal(gpu_smooth.smooth(points, triangles.astype(kind)), smoothed)
    assert np.array_equal(gpu_smooth.smooth(points, triangles.astype(">i4")), smoothed)
    assert np.array_equal(gpu_smooth.smooth(points, triangles.tolist()), smoothed)
    integers = np.round(points * 1000).astype(np.int32)
    of_integers = gpu_smooth.smooth(integers, triangles)
    assert np.array_equal(of_integers, gpu_smooth.smooth(integers.astype(float), triangles))


def test_fixed_vertices_lines_and_regions_stay(mesh: Mesh) -> None:
    points, triangles = mesh
    middle = np.flatnonzero((np.arange(len(points)) % 13 == 6))
    moved = gpu_smooth.smooth(points, triangles, fixed=middle)
    assert np.array_equal(moved[middle], points[middle]) and not np.array_equal(moved, points)
    mask = np.isin(np.arange(len(points)), middle)
    assert np.array_equal(gpu_smooth.smooth(points, triangles, fixed=mask), moved)
    lines = np.stack([middle[:-1], middle[1:]], axis=1)
    assert np.array_equal(gpu_smooth.smooth(points, triangles, lines=lines), moved)
    regions = points[triangles].mean(axis=1)[:, 0] > 6.1
    cells = triangles[:, 0] % 13 >= 6
    assert regions.any()
    of_regions = gpu_smooth.smooth(points, triangles, regions=np.where(cells, 7, -3))
    assert np.array_equal(of_regions, moved)


def test_vertices_slide_along_lines_inside_and_fixed_vertices_do_not() -> None:
    points, triangles = lattice(8, by=0.0)
    points[:, 1] += 0.3 * np.sin(points[:, 1] * np.pi / 8) ** 2 * (points[:, 1] % 8 > 0)
    middle = np.flatnonzero(np.arange(len(points)) % 9 == 4)
    lines = np.stack([middle[:-1], middle[1:]], axis=1)
    # A named method runs without the floor, which keeps the angles of these right triangles.
    result = gpu_smooth.run(points, triangles, lines=lines, slide=True, method="multilevel")
    assert result.slid > 0
    assert np.array_equal(result.points[middle, 0], points[middle, 0]), "the line is straight"
    assert np.abs(result.points[middle, 1] - points[middle, 1]).max() > 0.01
    held = gpu_smooth.run(points, triangles, lines=lines, slide=True, fixed=middle)
    assert np.array_equal(held.points[middle], points[middle])


def test_coincident_vertices_of_two_parts_slide_together() -> None:
    points, triangles = lattice(8, by=0.0)
    points[:, 1] += 0.3 * np.sin(points[:, 1] * np.pi / 8) ** 2 * (points[:, 1] % 8 > 0)
    middle = np.flatnonzero(np.arange(len(points)) % 9 == 4)
    copies = len(points) + np.arange(len(middle))
    of_right = points[triangles].mean(axis=1)[:, 0] > 4
    number = np.arange(len(points))
    number[middle] = copies
    triangles[of_right] = number[triangles[of_right]]
    both = np.concatenate([points, points[middle]])
    result = gpu_smooth.run(both, triangles, slide=True, method="multilevel")
    assert np.array_equal(result.points[middle], result.points[copies])
    assert np.abs(result.points[middle] - points[middle]).max() > 0.01


@pytest.mark.parametrize("engine", ["cpu", "gpu"])
def test_right_triangles_do_not_become_sharp_by_default(engine: Any) -> None:
    # Sweeps would leave an angle of 36 degrees, and no vertex can move without an angle below 45 degrees.
    points, triangles = alternating(12)
    result = gpu_smooth.run(points, triangles, engine=engine)
    assert result.floored == 121 and np.array_equal(result.points, points)
    sharp = gpu_smooth.run(points, triangles, engine=engine, method="multilevel")
    assert sharp.floored == 0 and sharp.quality_after.min_angle < 40.0


def test_targets_may_be_sizes_tensors_and_values_of_another_mesh(mesh: Mesh) -> None:
    points, triangles = mesh
    sizes = 1.0 + points[:, 0]
    by_sizes = gpu_smooth.smooth(points, triangles, target=sizes, scheme="soft-size")
    tensors = np.stack([sizes**-2, 0 * sizes, sizes**-2], axis=1)
    by_tensors = gpu_smooth.smooth(points, triangles, target=tensors, scheme="soft-size")
    assert np.abs(by_sizes - by_tensors).max() < 1e-9
    assert np.abs(by_sizes - gpu_smooth.smooth(points, triangles, scheme="soft-size")).max() > 0.1
    # A metric that sees no sizes would ignore sizes.
    default = gpu_smooth.run(points, triangles, target=sizes)
    assert default.metric == "soft-size"
    corners = np.array([[0.0, 0], [12, 0], [12, 12], [0, 12]])
    background = (corners, [[0, 1, 2], [0, 2, 3]], 1.0 + corners[:, 0])
    of_places = gpu_smooth.smooth(points, triangles, target=background)
    of_vertices = gpu_smooth.smooth(points, triangles, target=background, target_of="vertex")
    assert not np.array_equal(of_places, of_vertices)
    x = of_places[:, 0]
    edges = of_places[triangles[:, 1:]] - of_places[triangles[:, :1]]
    area = np.abs(np.linalg.det(edges))
    left, right = area[x[triangles].mean(1) < 4].mean(), area[x[triangles].mean(1) > 8].mean()
    assert right > 1.5 * left


def test_a_result_reports_the_run(mesh: Mesh) -> None:
    points, triangles = mesh
    result = gpu_smooth.run(points, triangles, scheme="rms", history="all", engine="cpu")
    assert np.array_equal(result.points, gpu_smooth.smooth(points, triangles, scheme="rms"))
    assert np.array_equal(result.points_before, points)
    assert np.array_equal(result.displacement, result.points - points)
    assert (result.stop, result.engine, result.metric) == ("converged", "cpu", "rms")
    assert len(result.history) == result.sweeps + 1 and set(result.histories) == set(METRICS)
    assert abs(result.history[0] - result.quality_before.f("rms")) < 1e-9
    assert abs(result.history[-1] - result.quality_after.f("rms")) < 1e-6
    assert result.quality_after.inverted == 0 and result.seconds > 0
    assert 0 <= result.best_sweep <= result.sweeps and result.held_back >= 0
    assert result.corrections == 0 and 0 < result.newton_steps < result.sweeps
    assert result.newton_iterations >= result.newton_steps
    q = gpu_smooth.quality(result.points, triangles, "rms")
    assert abs((q**2).mean() - result.quality_after.f("rms")) < 1e-12
    worst = gpu_smooth.quality(result.points, triangles, "imr").max()
    assert abs(result.quality_after.worst_imr - worst) < 1e-12
    assert "converged" in repr(result)
    # The text names one objective, with the values of the quality.
    before, after = result.quality_before.f("rms"), result.quality_after.f("rms")
    assert f"f rms {before:.6g} -> {after:.6g}" in repr(result)


def test_f_relative_to_targets_has_another_name(mesh: Mesh) -> None:
    points, triangles = mesh
    result = gpu_smooth.run(points * [1.0, 9.0], triangles, target="keep-shape")
    assert result.has_target
    before, after = result.history[0], result.history[result.best_sweep]
    assert f"f of targets {before:.6g} -> {after:.6g}" in repr(result)
    assert "f of targets" in result._repr_html_() and "f imr" not in result._repr_html_()


def test_a_smoother_runs_many_times(mesh: Mesh) -> None:
    points, triangles = mesh
    smoother = gpu_smooth.Smoother(points, triangles[:, ::-1], target="keep-size", fixed=[30])
    assert smoother.free.sum() == 11 * 11 - 1 and not smoother.free[30]
    corners = points[smoother.triangles]
    edges = corners[:, 1:] - corners[:, :1]
    assert (edges[:, 0, 0] * edges[:, 1, 1] > edges[:, 0, 1] * edges[:, 1, 0]).all()
    first = smoother.run(scheme="shape-size", max_sweeps=2)
    second = smoother.run()
    assert first.sweeps == 2 and second.stop == "converged"
    same = gpu_smooth.smooth(points, triangles[:, ::-1], target="keep-size", fixed=[30])
    assert np.array_equal(second.points, same)
    with pytest.raises(TypeError, match="pass it to Smoother.run"):
        gpu_smooth.Smoother(points, triangles, scheme="imr")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="Smoother.run has no option"):
        smoother.run(target="keep-size")  # type: ignore[call-arg]


def test_on_sweep_sees_the_run_and_may_end_it() -> None:
    points, triangles = lattice(150)
    seen: list[gpu_smooth.Progress] = []
    full = gpu_smooth.run(points, triangles, on_sweep=seen.append, engine="cpu")
    assert full.stop == "converged" and seen[-1].phase == "smoothing"
    assert all(seen[k].sweep <= seen[k + 1].sweep for k in range(len(seen) - 1))

    def stop(progress: gpu_smooth.Progress) -> bool:
        return progress.sweep >= 2

    ended = gpu_smooth.run(points, triangles, on_sweep=stop, engine="cpu", tolerance=0)
    assert ended.stop == "canceled" and ended.sweeps < 100
    assert ended.quality_after.f() < ended.quality_before.f()

    def stop_iteration(progress: gpu_smooth.Progress) -> None:
        raise StopIteration

    ended = gpu_smooth.run(points, triangles, on_sweep=stop_iteration, engine="cpu", tolerance=0)
    assert ended.stop == "canceled"

    def fail(progress: gpu_smooth.Progress) -> None:
        raise RuntimeError("of the user")

    with pytest.raises(RuntimeError, match="of the user"):
        gpu_smooth.run(points, triangles, on_sweep=fail)
    with pytest.raises(OptionError, match="on_sweep"):
        gpu_smooth.run(points, triangles, on_sweep=3)  # type: ignore[arg-type]


def test_a_time_limit_ends_a_run() -> None:
    points, triangles = lattice(200)
    start = time.perf_counter()
    result = gpu_smooth.run(
        points, triangles, time_limit=0.2, tolerance=0, max_sweeps=10**9, method="relaxed", engine="cpu"
    )
    assert result.stop == "canceled" and 0.1 < time.perf_counter() - start < 10


@pytest.mark.parametrize("function", [gpu_smooth.run, gpu_smooth.smooth])
def test_the_time_limit_and_the_function_of_a_run_include_untangling(function: Any, mesh: Mesh) -> None:
    points, triangles = mesh
    points[[40, 80]] += [2.5, 2.5]
    seen: list[gpu_smooth.Progress] = []
    function(points, triangles, untangle=True, on_sweep=seen.append)
    assert {"untangling", "smoothing"} <= {progress.phase for progress in seen}
    for options in {"time_limit": 0.0}, {"on_sweep": lambda progress: True}:
        with pytest.raises(MeshError, match="triangles? stays? inverted or flat after"):
            function(points, triangles, untangle=True, **options)
    smoother = gpu_smooth.Smoother(points, triangles, untangle=True)
    assert smoother.run(time_limit=0.0).stop == "canceled"
    with pytest.raises(MeshError, match="triangles? stays? inverted or flat after"):
        smoother.run(points, time_limit=0.0)


def test_a_tangled_mesh_is_refused_or_untangled(mesh: Mesh) -> None:
    points, triangles = mesh
    tangled = points.copy()
    tangled[[40, 80]] += [2.5, 2.5]
    with pytest.raises(MeshError, match="untangle=True") as refused:
        gpu_smooth.smooth(tangled, triangles)
    bad = gpu_smooth.quality(tangled, triangles, "scaled-jacobian") <= 0
    assert list(refused.value.triangles) == np.flatnonzero(bad).tolist() != []
    result = gpu_smooth.run(tangled, triangles, untangle=True)
    assert result.quality_before.inverted == bad.sum() and result.quality_after.inverted == 0
    assert np.array_equal(result.points_before, tangled)
    untangled = gpu_smooth.untangle(tangled, triangles)
    assert (gpu_smooth.quality(untangled, triangles, "scaled-jacobian") > 0).all()
    assert (untangled == tangled).all(axis=1).sum() > 60, "vertices far away keep their points"
    assert np.array_equal(gpu_smooth.smooth(untangled, triangles), result.points)


def test_triangles_without_a_free_vertex_cannot_be_untangled() -> None:
    points, triangles = lattice(12, by=0.0)
    fixed = np.arange(len(points))
    crossed = points.copy()
    crossed[40] += [2.5, 2.5]
    with pytest.raises(MeshError, match="the fixed edges from vertex .* cross"):
        gpu_smooth.untangle(crossed, triangles, fixed=fixed)
    flat = points.copy()
    flat[40] = 0.5 * (flat[39] + flat[53])
    with pytest.raises(MeshError, match="^triangles: triangle 36 cannot be untangled, as none of its vertices") as refused:
        gpu_smooth.untangle(flat, triangles, fixed=fixed)
    area = gpu_smooth.quality(flat, triangles, "scaled-jacobian")
    assert list(refused.value.triangles) == np.flatnonzero(area <= 0).tolist() != []
    kept = gpu_smooth.untangle(flat, triangles, fixed=fixed, keep_going=True)
    assert np.array_equal(kept, flat)
