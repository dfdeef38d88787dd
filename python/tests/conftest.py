"""Meshes for the tests."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

Points = npt.NDArray[np.float64]
Triangles = npt.NDArray[np.int64]
MESHES = Path(__file__).parents[2] / "meshes"


def lattice(side: int, seed: int = 1, by: float = 0.24) -> tuple[Points, Triangles]:
    """Return a square of `side` by `side` cells, whose inner vertices are moved by up to `by` of a cell."""
    across = np.arange(side + 1.0)
    points = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)
    corner = (np.arange(side) + (side + 1) * np.arange(side)[:, None]).ravel()
    lower = np.stack([corner, corner + 1, corner + side + 2], axis=1)
    upper = np.stack([corner, corner + side + 2, corner + side + 1], axis=1)
    is_inner = np.logical_and(points > 0, points < side).all(axis=1)
    moves = np.random.default_rng(seed).uniform(-by, by, points.shape)
    moves[~is_inner] = 0.0
    return points + moves, np.concatenate([lower, upper])


def squares(side: int) -> Triangles:
    """Return the cells of `lattice(side)` as quadrilaterals, of shape (side * side, 4)."""
    corner = (np.arange(side) + (side + 1) * np.arange(side)[:, None]).ravel()
    return np.stack([corner, corner + 1, corner + side + 2, corner + side + 1], axis=1)


def mixed(side: int) -> tuple[Triangles, Triangles]:
    """Return the cells of `lattice(side)`: triangles of the left half, and quadrilaterals of the right half."""
    _, triangles = lattice(side)
    cells = squares(side)
    middle = side // 2
    return triangles[triangles[:, 0] % (side + 1) < middle], cells[cells[:, 0] % (side + 1) >= middle]


def across_date_line(points: Points) -> tuple[Points, Points]:
    """Return points of `lattice(12)` in degrees, around longitude 180, as they are and with longitudes from -180 to 180."""
    continued = points * [0.2, 0.1] + [178.9, 60.0]
    wrapped = continued.copy()
    wrapped[wrapped[:, 0] > 180, 0] -= 360
    return continued, wrapped


def polar_cap() -> tuple[Points, Triangles]:
    """Return a mesh in degrees around the North Pole, which is vertex 0, with some vertices moved; it closes around the globe."""
    longitudes, latitudes = np.meshgrid(np.arange(-180.0, 180.0, 30.0), [80.0, 70.0, 60.0, 50.0])
    rings = np.stack([longitudes, latitudes], axis=-1).reshape(-1, 2)
    rings[12:36] += np.random.default_rng(2).uniform(-4.0, 4.0, (24, 2))
    # A longitude may also be that of the date line on its other side.
    rings[:, 0] = (rings[:, 0] + 180.0) % 360.0 - 180.0
    own = 1 + np.arange(36)
    beside = np.where(own % 12 == 0, own - 11, own + 1)
    around = [np.stack([np.zeros(12, int), own[:12], beside[:12]], axis=1)]
    around += [np.stack([own, own + 12, beside + 12], axis=1), np.stack([own, beside + 12, beside], axis=1)]
    return np.concatenate([[[0.0, 90.0]], rings]), np.concatenate(around)


def alternating(side: int) -> tuple[Points, Triangles]:
    """Return a square of right triangles whose diagonals alternate from row to row; sweeps by imr would make them sharper."""
    points, triangles = lattice(side, by=0.0)
    corner = (np.arange(side) + (side + 1) * np.arange(1, side, 2)[:, None]).ravel()
    odd = np.isin(triangles[:, 0], corner)
    lower = np.stack([corner, corner + 1, corner + side + 1], axis=1)
    upper = np.stack([corner + 1, corner + side + 2, corner + side + 1], axis=1)
    return points, np.concatenate([triangles[~odd], lower, upper])


def written(
    path: Path,
    points: npt.NDArray[Any],
    triangles: Triangles,
    edges: npt.NDArray[np.int64] | tuple[()] = (),
    quadrilaterals: npt.NDArray[np.int64] | tuple[()] = (),
) -> Path:
    """Write a mesh as a VTK file of the type of the points, with all digits. Points of two coordinates get z = 0.

    `edges` are written as lines, of shape (k, 2), and `quadrilaterals` have the shape (k, 4).
    """
    kind = {"float64": "double", "float32": "float"}[points.dtype.name]
    rows = [" ".join(map(str, row)) + " 0" * (3 - len(row)) for row in points.tolist()]
    of_kinds = [triangles, np.asarray(edges), np.asarray(quadrilaterals)]
    cells = [f"{len(row)} " + " ".join(map(str, row)) for own in of_kinds for row in own.tolist()]
    types = [kind for kind, own in zip("539", of_kinds) for _ in own]
    size = sum(own.size + len(own) for own in of_kinds)
    head = "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    lines = [f"POINTS {len(rows)} {kind}", *rows, f"CELLS {len(cells)} {size}", *cells]
    lines += [f"CELL_TYPES {len(cells)}", *types]
    path.write_text(head + "\n".join(lines) + "\n")
    return path


def command_line(*words: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the command line of the installed package."""
    command = [sys.executable, "-m", "gpu_smooth", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture
def mesh() -> tuple[Points, Triangles]:
    return lattice(12)


@pytest.fixture
def plate() -> Path:
    return MESHES / "plate.node"
