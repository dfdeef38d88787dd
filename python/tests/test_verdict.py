"""Measures of quadrilaterals by Verdict, as VTK evaluates them."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import pytest
from conftest import MESHES

pytestmark = pytest.mark.heavy

# Measures of gpu-smooth, with the names that VTK's functions have after `Quad`.
MEASURES = {
    "min-angle": "MinAngle", "max-angle": "MaxAngle", "edge-ratio": "EdgeRatio", "aspect-ratio": "AspectRatio",
    "radius-ratio": "RadiusRatio", "scaled-jacobian": "ScaledJacobian", "condition": "Condition", "shape": "Shape",
    "med-aspect-frobenius": "MedAspectFrobenius", "skewness": "EquiangleSkew",
}
STORED = MESHES.parent / "tests" / "measures" / "verdict.txt"
HEAD = f"""# Measures of convex quadrilaterals by Verdict in VTK 9.7. `GPU_SMOOTH_GOLDEN=write python/tests/run --all test_verdict.py` writes the file.
# x and y of four vertices, {", ".join(MEASURES)}
"""


def random_quadrilaterals(count: int) -> Any:
    """Return convex quadrilaterals of many shapes, counter-clockwise, of shape (count, 4, 2)."""
    random = np.random.default_rng(7)
    found: list[Any] = []
    while len(found) < count:
        square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) + random.uniform(-0.5, 0.5, (4, 2))
        stretch = np.diag([1, 10 ** random.uniform(-1.5, 1.5)])
        shear = np.array([[1, random.uniform(-1, 1)], [0, 1]])
        angle = random.uniform(0, 2 * np.pi)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        one = np.round(square @ (turn @ shear @ stretch).T, 4)
        sides = np.roll(one, -1, axis=0) - one
        before = np.roll(sides, 1, axis=0)
        if (before[:, 0] * sides[:, 1] - before[:, 1] * sides[:, 0] > 1e-3).all():
            found.append(one)
    return np.array(found)


def test_stored_measures_of_quadrilaterals_are_those_of_vtk() -> None:
    from vtkmodules.vtkCommonDataModel import vtkQuad
    from vtkmodules.vtkFiltersVerdict import vtkMeshQuality

    rows = []
    for corners in random_quadrilaterals(40):
        cell = vtkQuad()
        for k, (x, y) in enumerate(corners.tolist()):
            cell.GetPoints().SetPoint(k, x, y, 0.0)
        values = [getattr(vtkMeshQuality, f"Quad{name}")(cell) for name in MEASURES.values()]
        rows.append([*corners.ravel().tolist(), *values])
    if os.environ.get("GPU_SMOOTH_GOLDEN") == "write":
        STORED.write_text(HEAD + "".join(" ".join(map(str, row)) + "\n" for row in rows))
    np.testing.assert_allclose(np.loadtxt(STORED), rows, rtol=1e-12, atol=1e-14)
