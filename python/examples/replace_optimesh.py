"""Replaces `optimesh.optimize_points_cells`, which is no longer free software, without other changes to a program.

Run: python replace_optimesh.py
"""

from __future__ import annotations

import argparse

import numpy as np
import numpy.typing as npt

import gpu_smooth


def optimize_points_cells(
    points: npt.NDArray[np.float64],
    cells: npt.NDArray[np.int64],
    method: str = "imr",
    tol: float = 1e-6,
    max_num_steps: int = 1000,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Take the arguments of optimesh, with a metric of `gpu_smooth.metrics()` as the method.

    The cells stay as they are: gpu-smooth swaps no edges, and inverts no triangle.
    """
    smoothed = gpu_smooth.smooth(
        points, cells, scheme=method, tolerance=tol, max_sweeps=max_num_steps
    )
    return smoothed.astype(np.float64), cells


def disk(rings: int, seed: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Return a mesh of the unit disk with 6 k vertices on ring k, whose inner vertices are moved at random."""
    numbers = range(1, rings + 1)
    angles = [2 * np.pi * np.arange(6 * k) / (6 * k) for k in numbers]
    of_rings = [k / rings * np.stack([np.cos(a), np.sin(a)], axis=1) for k, a in zip(numbers, angles)]
    points = np.concatenate([np.zeros((1, 2)), *of_rings])
    cells = []
    for k in numbers:
        # In each of the six sectors, a strip of triangles joins ring k to the ring inside.
        outer, inner = 1 + 3 * k * (k - 1), 1 + 3 * (k - 1) * (k - 2) if k > 1 else 0
        for sector in range(6):
            out = [outer + (sector * k + j) % (6 * k) for j in range(k + 1)]
            count = 6 * (k - 1) if k > 1 else 1
            within = [inner + (sector * (k - 1) + j) % count for j in range(k)]
            cells += [(out[j], out[j + 1], within[j]) for j in range(k)]
            cells += [(within[j], out[j + 1], within[j + 1]) for j in range(k - 1)]
    moves = np.random.default_rng(seed).uniform(-0.3, 0.3, points.shape) / rings
    moves[np.linalg.norm(points, axis=1) > 1 - 0.5 / rings] = 0
    return points + moves, np.array(cells)


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    points, cells = disk(20, seed=1)
    before = gpu_smooth.quality(points, cells, "min-angle")
    points, cells = optimize_points_cells(points, cells)
    after = gpu_smooth.quality(points, cells, "min-angle")
    print(f"least angle {before.min():.1f} -> {after.min():.1f} degrees, mean {before.mean():.1f} -> {after.mean():.1f}")


if __name__ == "__main__":
    main()
