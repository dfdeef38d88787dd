"""Functions on arrays beside smoothing."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from conftest import Points, Triangles, across_date_line

import gpu_smooth
from gpu_smooth import _native

Mesh = tuple[Points, Triangles]


def test_measures_agree_with_formulas(mesh: Mesh) -> None:
    points, triangles = mesh
    corners = points[triangles]
    edges = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(edges, axis=2)
    area = 0.5 * np.abs(edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0])
    cosines = -(edges * np.roll(edges, 1, axis=1)).sum(axis=2)
    angles = np.degrees(np.arccos(cosines / (lengths * np.roll(lengths, 1, axis=1))))
    imr = (lengths**2).sum(axis=1) / (4 * np.sqrt(3) * area)
    expected = {
        "imr": imr,
        "shape": 1 / imr,
        "edge-ratio": lengths.max(axis=1) / lengths.min(axis=1),
        "min_angle": angles.min(axis=1),
        "max-angle": angles.max(axis=1),
    }
    for measure, values in expected.items():
        found = gpu_smooth.quality(points, triangles, measure)
        assert found.dtype == np.float64 and np.abs(found / values - 1).max() < 1e-9, measure
    assert np.array_equal(gpu_smooth.quality(points, triangles), gpu_smooth.quality(points, triangles, "imr"))
    with pytest.raises(gpu_smooth.OptionError, match="no measure is called 'roundness'"):
        gpu_smooth.quality(points, triangles, "roundness")


def test_tables_have_a_row_for_each_metric_and_measure() -> None:
    metrics, measures = gpu_smooth.metrics(), gpu_smooth.measures()
    assert {metric.name for metric in metrics} <= {measure.name for measure in measures}
    for measure in measures:
        low, high = measure.range
        assert low <= measure.ideal <= high and measure.source and measure.formula
        values = gpu_smooth.quality([[0, 0], [1, 0], [0.5, 0.75**0.5]], [[0, 1, 2]], measure.name)
        assert abs(values[0] - measure.ideal) < 1e-6, measure
    assert all(metric.formula and metric.source and metric.purpose for metric in metrics)


def test_the_scale_of_colors_has_the_unit_of_a_measure_in_any_spelling_of_its_name() -> None:
    for spelling in "min-angle", "Min_Angle", " min_angle\n":
        assert _native.color_scale(spelling, None)["unit"] == "°"
    assert _native.color_scale("shape", None)["unit"] == ""


def test_interpolation_keeps_linear_data(mesh: Mesh) -> None:
    points, triangles = mesh
    moved = gpu_smooth.smooth(points, triangles)

    def linear(at: npt.NDArray[Any]) -> Points:
        return np.stack([at[:, 0] - 2 * at[:, 1], 3 + at[:, 1]], axis=1)

    found = gpu_smooth.interpolate(points, triangles, moved, linear(points))
    assert found.shape == (len(points), 2)
    assert np.abs(found - linear(moved)).max() < 1e-12
    flat = gpu_smooth.interpolate(points, triangles, moved, linear(points)[:, 0])
    assert np.array_equal(flat, found[:, 0])
    with pytest.raises(gpu_smooth.MeshError, match="moved: 5 points"):
        gpu_smooth.interpolate(points, triangles, moved[:5], linear(points))
    with pytest.raises(gpu_smooth.MeshError, match="values"):
        gpu_smooth.interpolate(points, triangles, moved, linear(points)[:5])


@pytest.mark.filterwarnings("ignore:points. the mesh is adapted:gpu_smooth.MeshWarning")
def test_meshes_across_the_date_line_are_measured_interpolated_and_compared_as_elsewhere(mesh: Mesh) -> None:
    continued, wrapped = across_date_line(mesh[0])
    triangles = mesh[1]
    for measure in ("min-angle", "orthogonality", "size-ratio"):
        found = gpu_smooth.quality(wrapped, triangles, measure, surface="sphere")
        np.testing.assert_allclose(found, gpu_smooth.quality(continued, triangles, measure, surface="sphere"), rtol=1e-9, atol=1e-9)
    moved, new = [gpu_smooth.smooth(points, triangles, surface="sphere") for points in (continued, wrapped)]
    assert np.ptp(new[:, 0]) > 359 and np.array_equal(moved[:, 1], new[:, 1])
    values = np.column_stack([2 * continued[:, 0] - continued[:, 1], continued[:, 1]])
    found = gpu_smooth.interpolate(wrapped, triangles, new, values, surface="sphere")
    np.testing.assert_allclose(found, np.column_stack([2 * moved[:, 0] - moved[:, 1], moved[:, 1]]), atol=1e-10)
    with pytest.raises(gpu_smooth.MeshError, match="inverted or flat"):
        gpu_smooth.interpolate(wrapped, triangles, new, values)
    here, there = [
        gpu_smooth.compare(*states, triangles, surface="sphere") for states in ((continued, moved), (wrapped, new))
    ]
    assert there.moved == pytest.approx(here.moved) and there.least_altitude == pytest.approx(here.least_altitude)
    assert there.quality_after.min_angle == pytest.approx(here.quality_after.min_angle)
    assert there.vertices_moved == here.vertices_moved and there.moved.most < 0.6


def test_a_displacement_across_the_date_line_is_the_shorter_way(mesh: Mesh) -> None:
    points, triangles = mesh
    points[:, 0] += 0.5
    kinds: list[Any] = [np.float64, np.float32]
    for kind in kinds:
        wrapped = across_date_line(points)[1].astype(kind)
        result = gpu_smooth.run(wrapped, triangles, surface="sphere")
        crossed = np.abs(result.points[:, 0] - wrapped[:, 0]) > 180.0
        assert crossed.any() and result.displacement.dtype == kind
        assert np.abs(result.displacement).max() < 0.1
        kept = ~crossed
        assert np.array_equal(result.displacement[kept], (result.points - wrapped)[kept])
        assert pickle.loads(pickle.dumps(result)).displacement.tolist() == result.displacement.tolist()


def test_two_states_are_compared(mesh: Mesh) -> None:
    points, triangles = mesh
    same = gpu_smooth.compare(points, points, triangles)
    assert same.vertices_moved == 0 and same.moved.most == 0 and not same.z_changed
    after = np.column_stack([points, np.ones(len(points))])
    after[20, 0] += 0.01
    before = np.column_stack([points, np.zeros(len(points))])
    found = gpu_smooth.compare(before, after, triangles)
    assert found.vertices_moved == 1 and found.z_changed and 0.005 < found.moved.most < 0.02
    assert found.quality_before.f() != found.quality_after.f()
    assert found.least_altitude[0] > 0
