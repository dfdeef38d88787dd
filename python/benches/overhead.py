"""Measures the cost of the Python package beside the library: the import, and calls on small and large meshes.

Run: python overhead.py [--large]; prints the rows of a table of docs/python.md. Build the package with optimization first:
pip install ./python
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

import gpu_smooth


def lattice(side: int) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """Return a square of `side` by `side` cells, whose inner vertices are moved at random."""
    across = np.arange(side + 1.0)
    points: npt.NDArray[np.float64] = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)
    corner = (np.arange(side) + (side + 1) * np.arange(side)[:, None]).ravel()
    lower = np.stack([corner, corner + 1, corner + side + 2], axis=1)
    upper = np.stack([corner, corner + side + 2, corner + side + 1], axis=1)
    moves = np.random.default_rng(1).uniform(-0.24, 0.24, points.shape)
    moves[~np.logical_and(points > 0, points < side).all(axis=1)] = 0
    return points + moves, np.concatenate([lower, upper])


def least(call: Callable[[], float], rounds: int) -> float:
    """Return the median of the least ten results of a call."""
    return float(np.median(sorted(call() for _ in range(rounds))[:10]))


def overhead(side: int, rounds: int, keep_layers: str) -> tuple[float, float]:
    """Return the time of `run` beyond preparation and run of the library, and the time of both, in seconds."""
    points, triangles = lattice(side)
    spent = []

    def call() -> float:
        start = time.perf_counter()
        result = gpu_smooth.run(points, triangles, engine="cpu", keep_layers=keep_layers)
        total = time.perf_counter() - start
        inside = result.prepare_seconds + result.seconds
        spent.append(inside)
        return total - inside

    return least(call, rounds), float(np.median(sorted(spent)[:10]))


def of_import() -> float:
    """Return the time of `import gpu_smooth` after `import numpy`, in seconds."""
    code = (
        "import numpy, numpy.typing, time; start = time.perf_counter(); import gpu_smooth;"
        "print(time.perf_counter() - start)"
    )
    return least(lambda: float(subprocess.check_output([sys.executable, "-I", "-c", code])), 15)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="also measure 1,000,000 vertices, which takes a minute")
    is_large = parser.parse_args().large
    print(f"| `import gpu_smooth`, after NumPy | {1e3 * of_import():.1f} ms |")
    sizes = [(9, 3000), (99, 100)]
    if is_large:
        sizes.append((999, 25))
    for side, rounds in sizes:
        beyond, library = overhead(side, rounds, "none")
        layers = overhead(side, rounds, "auto")[0] - beyond
        vertices = (side + 1) ** 2
        share = 100 * beyond / library
        print(
            f"| {vertices:,} vertices | {1e6 * library:,.0f} µs in the library, {1e6 * beyond:,.0f} µs beyond ({share:.1f} %), "
            f"{1e6 * layers:,.0f} µs to find boundary layers |"
        )


if __name__ == "__main__":
    main()
