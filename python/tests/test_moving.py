"""Runs of a prepared mesh from new points."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gpu_smooth
import numpy as np
import pytest
from conftest import Points, Triangles, lattice
from gpu_smooth import MeshError, OptionError


def with_hole(side: int) -> tuple[Points, Triangles, Any]:
    """Return a lattice with a hole in its middle, and the flags of the vertices of the hole's boundary."""
    points, triangles = lattice(side, by=0.1)
    is_near = np.abs(points - side / 2).max(axis=1) < side / 6
    kept = triangles[~is_near[triangles].all(axis=1)]
    used, kept = np.unique(kept, return_inverse=True)
    points, triangles = points[used], kept.reshape(-1, 3)
    return points, triangles, is_near[used] & ~gpu_smooth.Smoother(points, triangles).free


def is_valid(points: Any, triangles: Triangles) -> bool:
    return bool((gpu_smooth.quality(points, triangles, "scaled-jacobian") > 0).all())


def agree(result: gpu_smooth.Result, points: Points, triangles: Triangles, **options: Any) -> None:
    """Check that a result has no inverted triangle, and f of a call of `run` for the same points, which has other bits."""
    fresh = gpu_smooth.run(points, triangles, engine="cpu", **options)
    assert is_valid(result.points, triangles)
    assert np.array_equal(result.points_before, fresh.points_before)
    assert result.quality_before.f() == fresh.quality_before.f()
    assert result.history[result.best_sweep] == pytest.approx(fresh.history[fresh.best_sweep], rel=3e-6)


def test_a_hole_that_moves_is_followed_by_the_mesh() -> None:
    points, triangles, hole = with_hole(18)
    smoother = gpu_smooth.Smoother(points, triangles)
    place = points[hole]
    moved = points.copy()
    for step in range(40):
        moved[hole] = place + [2.0 * np.sin(step / 6), np.sin(step / 3)]
        before = moved.copy()
        result = smoother.run(moved, engine="cpu")
        assert np.array_equal(moved, before), "arguments are not changed"
        agree(result, moved, triangles)
        assert np.array_equal(result.points[hole], moved[hole])
        assert np.array_equal(result.displacement, result.points - moved)
        moved = np.asarray(result.points, float)
    assert np.array_equal(smoother.run(engine="cpu").points, gpu_smooth.smooth(points, triangles, engine="cpu"))
    again = smoother.run(points=points, engine="cpu")
    assert np.array_equal(again.points, smoother.run(engine="cpu").points), "the order of vertices is the same"


@pytest.mark.parametrize(
    "options",
    [{"target": "keep-shape"}, {"target": "keep-size", "fixed": [40]}, {"slide": True}, {"target": "sizes"}],
    ids=str,
)
def test_targets_and_curves_are_those_of_the_new_points(options: dict[str, Any]) -> None:
    points, triangles = lattice(12)
    if options.get("target") == "sizes":
        options = {"target": 1.0 + points[:, 0]}
    smoother = gpu_smooth.Smoother(points, triangles, **options)
    first = smoother.run(engine="cpu")
    moved = points * [1.0, 1.7]
    moved[:, 0] += 0.3 * np.sin(moved[:, 1])
    result = smoother.run(moved, engine="cpu")
    agree(result, moved, triangles, **options)
    assert result.slid == 0 or result.slid > 10
    assert [remark for remark in result.remarks if "target" in remark] == [
        remark for remark in gpu_smooth.run(moved, triangles, engine="cpu", **options).remarks if "target" in remark
    ]
    assert len(smoother.run(engine="cpu").remarks) == len(first.remarks)


def test_points_that_invert_triangles_are_refused_or_untangled() -> None:
    points, triangles, hole = with_hole(18)
    moved = points.copy()
    moved[hole] += [2.6, 0.0]
    bad = np.flatnonzero(gpu_smooth.quality(moved, triangles, "scaled-jacobian") <= 0)
    assert len(bad)
    smoother = gpu_smooth.Smoother(points, triangles)
    with pytest.raises(MeshError, match=rf"inverted or flat: {bad[0]} .*untangle=True") as refused:
        smoother.run(moved)
    assert list(refused.value.triangles) == bad.tolist()
    untangling = gpu_smooth.Smoother(points, triangles, untangle=True)
    result = untangling.run(moved, engine="cpu")
    assert result.quality_before.inverted == len(bad)
    agree(result, moved, triangles, untangle=True)
    # A move that no position of other vertices can follow.
    moved[hole] += [60.0, 0.0]
    with pytest.raises(MeshError, match="points: "):
        untangling.run(moved)
    assert is_valid(untangling.run().points, triangles)


def test_new_points_keep_their_own_form_and_third_coordinates() -> None:
    points, triangles = lattice(8)
    plain = gpu_smooth.Smoother(points, triangles).run(points * 2.0, engine="cpu").points
    depths = np.arange(len(points), dtype=float)
    of_depths = gpu_smooth.Smoother(np.c_[points, depths], triangles, z="data")
    with_z = of_depths.run(np.c_[points * 2.0, depths + 5.0].astype(np.float32), engine="cpu").points
    assert with_z.dtype == np.float32 and np.array_equal(with_z[:, 2], (depths + 5.0).astype(np.float32))
    assert np.abs(with_z[:, :2] - plain).max() < 1e-3
    tilt = np.array([[1.0, 0.2, 0.3], [0.1, 1.0, -0.4]])
    tilted = gpu_smooth.Smoother(points @ tilt, triangles)
    moved = tilted.run((points * 2.0) @ tilt, engine="cpu").points
    fresh = gpu_smooth.smooth((points * 2.0) @ tilt, triangles, engine="cpu")
    assert np.abs(moved - fresh).max() < 1e-2 and moved.shape == (len(points), 3)
    with pytest.raises(MeshError, match="not in the plane of the points of the Smoother") as refused:
        tilted.run((points * 2.0) @ tilt + [0.0, 0.0, 1.0])
    assert refused.value.vertex == 0
    with pytest.raises(MeshError, match="shape"):
        tilted.run(points)
    with pytest.raises(MeshError, match="not in the plane"):
        gpu_smooth.Smoother(np.c_[points, 0 * depths], triangles).run(np.c_[points, points[:, 0]])


def test_wrong_points_and_options_are_refused(tmp_path: Path) -> None:
    points, triangles = lattice(6)
    smoother = gpu_smooth.Smoother(points, triangles)
    with pytest.raises(MeshError, match="48 points are given for the 49"):
        smoother.run(points[1:])
    points[5, 0] = np.nan
    with pytest.raises(MeshError, match=r"points\[5\]") as refused:
        smoother.run(points)
    assert refused.value.vertex == 5
    points, triangles = lattice(6)
    for option in ({"checkpoint": tmp_path / "c"}, {"resume": tmp_path / "c"}):
        with pytest.raises(OptionError, match="points does not go with checkpoint and resume.*Drop both"):
            smoother.run(points, **option)  # type: ignore[arg-type]
    for of_mesh, text in (({"surface": "sphere"}, "surface=\"sphere\""), ({"only_bad": 1.2}, "only_bad")):
        other = gpu_smooth.Smoother(points, triangles, **of_mesh)
        with pytest.raises(OptionError, match=f"points does not go with {text}.*Make a Smoother of the new points"):
            other.run(points)
