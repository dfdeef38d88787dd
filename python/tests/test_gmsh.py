"""The mesh of the running gmsh session."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gpu_smooth

pytestmark = pytest.mark.heavy


@pytest.fixture
def gmsh() -> Iterator[Any]:
    import gmsh

    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    yield gmsh
    gmsh.finalize()


def nodes(gmsh: Any) -> dict[int, tuple[float, ...]]:
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    return dict(zip(tags.tolist(), map(tuple, np.reshape(coordinates, (-1, 3)).tolist())))


def of_dimension(gmsh: Any, dimension: int) -> set[int]:
    found: set[int] = set()
    for _, entity in gmsh.model.getEntities(dimension):
        found |= set(gmsh.model.mesh.getNodes(dimension, entity)[0].tolist())
    return found


def square(gmsh: Any, periodic: bool = False) -> None:
    """Mesh a square with a point and a curve embedded, and a hole, coarsely and without gmsh's own smoothing."""
    model = gmsh.model.occ
    plate = model.cut([(2, model.addRectangle(0, 0, 0, 4, 4))], [(2, model.addDisk(3, 3, 0, 0.4, 0.4))])[0]
    point = model.addPoint(1.2, 1.3, 0)
    curve = model.addLine(model.addPoint(0.7, 2.5, 0), model.addPoint(1.9, 3.1, 0))
    model.synchronize()
    gmsh.model.mesh.embed(0, [point], 2, plate[0][1])
    gmsh.model.mesh.embed(1, [curve], 2, plate[0][1])
    if periodic:
        sides = {}
        for _, tag in gmsh.model.getEntities(1):
            low, high = np.reshape(gmsh.model.getBoundingBox(1, tag), (2, 3))
            if high[0] - low[0] < 1e-3 and high[1] - low[1] > 3.9:
                sides[round(low[0])] = tag
        gmsh.model.mesh.setPeriodic(1, [sides[4]], [sides[0]], [1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.3)
    gmsh.option.setNumber("Mesh.Smoothing", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 5)
    gmsh.model.mesh.generate(2)


def test_a_model_is_smoothed_in_place_and_its_geometry_stays(gmsh: Any) -> None:
    square(gmsh)
    before = nodes(gmsh)
    result = gpu_smooth.smooth_gmsh_model()
    after = nodes(gmsh)
    moved = {tag for tag in before if before[tag] != after[tag]}
    geometry = of_dimension(gmsh, 0) | of_dimension(gmsh, 1)
    assert len(moved) > 50 and not moved & geometry
    assert len(geometry) > 60, "the embedded point and curve have nodes"
    assert np.array_equal(result.points, list(after.values()))
    assert result.stop == "converged" and result.quality_after.f() < result.quality_before.f()
    tag = min(moved)
    place, parameters, _, _ = gmsh.model.mesh.getNode(tag)
    assert np.allclose(gmsh.model.getValue(2, gmsh.model.getEntities(2)[0][1], parameters), place)


def test_nodes_of_quadrilaterals_move_unless_told(gmsh: Any) -> None:
    gmsh.option.setNumber("Mesh.RecombineAll", 1)
    square(gmsh)
    before = nodes(gmsh)
    kinds, _, connectivity = gmsh.model.mesh.getElements(2)
    corners = set(connectivity[list(kinds).index(3)].tolist())
    geometry = of_dimension(gmsh, 0) | of_dimension(gmsh, 1)
    assert len(corners) > 100
    # All nodes inside are corners of quadrilaterals.
    with pytest.raises(gpu_smooth.MeshError, match="free to move|no quadrilaterals of four that move"):
        gpu_smooth.smooth_gmsh_model(quadrilaterals="keep")
    result = gpu_smooth.smooth_gmsh_model()
    after = nodes(gmsh)
    moved = {tag for tag in before if before[tag] != after[tag]}
    assert len(moved & corners) > 50 and not moved & geometry
    assert len(result.quadrilaterals) > 100 and result.quality_after.f() < result.quality_before.f()
    gmsh.option.setNumber("Mesh.RecombineAll", 0)


def test_nodes_slide_along_curves_and_periodic_nodes_in_pairs(gmsh: Any) -> None:
    square(gmsh, periodic=True)
    before = nodes(gmsh)
    result = gpu_smooth.smooth_gmsh_model(slide=True)
    after = nodes(gmsh)
    moved = {tag for tag in before if before[tag] != after[tag]}
    assert result.slid > 0 and moved & of_dimension(gmsh, 1) and not moved & of_dimension(gmsh, 0)
    pairs = 0
    for _, curve in gmsh.model.getEntities(1):
        master, own, of_master, _ = gmsh.model.mesh.getPeriodicNodes(1, curve)
        for a, b in zip(own.tolist(), of_master.tolist()):
            assert np.allclose(np.subtract(after[a], after[b]), [4, 0, 0], atol=1e-12)
            pairs += master != curve and a in moved
        for tag in set(gmsh.model.mesh.getNodes(1, curve)[0].tolist()) & moved:
            place, parameters, _, _ = gmsh.model.mesh.getNode(tag)
            assert np.allclose(gmsh.model.getValue(1, curve, parameters), place, atol=0.02)
    assert pairs > 3


def test_physical_groups_are_fixed_by_name(gmsh: Any) -> None:
    square(gmsh)
    curves = [tag for _, tag in gmsh.model.getEntities(1)]
    gmsh.model.setPhysicalName(1, gmsh.model.addPhysicalGroup(1, curves), "walls")
    before = nodes(gmsh)
    with pytest.raises(gpu_smooth.MeshError, match="no group 'wall'. Its groups are: walls"):
        gpu_smooth.smooth_gmsh_model(slide=True, fixed="wall")
    result = gpu_smooth.smooth_gmsh_model(slide=True, fixed=["walls"])
    assert result.slid == 0
    moved = {tag for tag, place in nodes(gmsh).items() if before[tag] != place}
    assert moved and not moved & of_dimension(gmsh, 1)


def test_a_model_in_another_plane_is_smoothed_in_it(gmsh: Any) -> None:
    square(gmsh)
    flat = gpu_smooth.smooth_gmsh_model(engine="cpu", tolerance=1e-12)
    for axis, angle in (((1, 0, 0), 0.5 * np.pi), ((1, 2, 0.5), 0.7)):
        gmsh.clear()
        square(gmsh)
        turn = rotation(axis, angle)
        gmsh.model.mesh.affineTransform(np.insert(turn, 3, 0, axis=1).ravel())
        before = nodes(gmsh)
        result = gpu_smooth.smooth_gmsh_model(engine="cpu", tolerance=1e-12)
        assert np.abs(result.points - flat.points @ turn.T).max() < 1e-5
        assert result.quality_after.f() < result.quality_before.f()
        assert nodes(gmsh) != before


def rotation(axis: Any, angle: float) -> Any:
    """Return the matrix of a rotation around an axis through the origin."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across


def test_models_that_cannot_be_smoothed_are_refused(gmsh: Any) -> None:
    with pytest.raises(gpu_smooth.MeshError, match=r"has no elements on surfaces. Mesh the model first: gmsh.model.mesh.generate\(2\)"):
        gpu_smooth.smooth_gmsh_model()
    gmsh.model.occ.addRectangle(0, 0, 0, 4, 4)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(1)
    with pytest.raises(gpu_smooth.MeshError, match="has no elements on surfaces"):
        gpu_smooth.smooth_gmsh_model()
    gmsh.clear()
    square(gmsh)
    gmsh.model.mesh.setOrder(2)
    with pytest.raises(gpu_smooth.MeshError, match="linear elements"):
        gpu_smooth.smooth_gmsh_model()
    gmsh.clear()
    gmsh.model.occ.addSphere(0, 0, 0, 1)
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(2)
    with pytest.raises(gpu_smooth.MeshError, match="is not planar"):
        gpu_smooth.smooth_gmsh_model()
    gmsh.model.mesh.generate(3)
    with pytest.raises(gpu_smooth.MeshError, match="volume elements"):
        gpu_smooth.smooth_gmsh_model()


def test_a_session_must_run() -> None:
    with pytest.raises(gpu_smooth.GpuSmoothError, match="no gmsh session"):
        gpu_smooth.smooth_gmsh_model()


@pytest.mark.filterwarnings("ignore:FigureCanvasAgg is non-interactive")
@pytest.mark.parametrize("document", ["README.md", "docs/python.md"])
def test_the_three_lines_of_the_documents_smooth_and_show_a_mesh(gmsh: Any, document: str) -> None:
    import matplotlib

    matplotlib.use("agg")
    text = (Path(__file__).parents[2] / document).read_text()
    code = text.split("```python\n")[1].split("```")[0]
    assert len(code.splitlines()) == 3
    square(gmsh)
    before = nodes(gmsh)
    names: dict[str, Any] = {}
    exec(code, names)
    assert nodes(gmsh) != before and names["result"].stop == "converged"
    assert len(names["result"].plot().axes) == 3


def test_groups_of_one_name_are_fixed_together(gmsh: Any) -> None:
    first, second = (gmsh.model.occ.addRectangle(x, 0, 0, 4, 4) for x in (0, 5))
    gmsh.model.occ.synchronize()
    curve = gmsh.model.getBoundary([(2, first)])[0][1]
    # Uneven nodes, which would slide.
    gmsh.model.mesh.setTransfiniteCurve(curve, 9, "Progression", 1.5)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.8)
    gmsh.model.mesh.generate(2)
    gmsh.model.addPhysicalGroup(1, [curve], name="held")
    gmsh.model.addPhysicalGroup(2, [second], name="held")
    before = nodes(gmsh)
    held = {*gmsh.model.mesh.getNodes(1, curve)[0].tolist(), *gmsh.model.mesh.getNodes(2, second)[0].tolist()}
    gpu_smooth.smooth_gmsh_model(fixed="held", slide=True)
    assert len(held) > 8 and all(nodes(gmsh)[tag] == before[tag] for tag in held) and nodes(gmsh) != before


def test_an_empty_list_of_fixed_nodes_keeps_the_constraints_of_the_model(gmsh: Any) -> None:
    square(gmsh)
    before = nodes(gmsh)
    gpu_smooth.smooth_gmsh_model(fixed=[], lines=[])
    on_curves = gmsh.model.mesh.getNodes(1, includeBoundary=True)[0].tolist()
    assert on_curves and all(nodes(gmsh)[tag] == before[tag] for tag in on_curves)
