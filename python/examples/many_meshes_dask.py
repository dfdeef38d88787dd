"""Smooths many meshes through Dask: on the cores of this machine, or on any cluster by the address of its scheduler.

Run: python many_meshes_dask.py [--meshes 1000] [--scheduler tcp://host:8786]; needs dask and distributed.
"""

from __future__ import annotations

import argparse

import numpy as np
import numpy.typing as npt
from distributed import Client, LocalCluster

import gpu_smooth


def smoothed(seed: int, side: int) -> float:
    """Smooth a lattice whose inner vertices are moved at random. Return the least angle after the run, in degrees.

    In use, this function would read a mesh from a file and write it. Only file names then go through the network.
    """
    across = np.arange(side + 1.0)
    points: npt.NDArray[np.float64] = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)
    corner = (np.arange(side) + (side + 1) * np.arange(side)[:, None]).ravel()
    lower = np.stack([corner, corner + 1, corner + side + 2], axis=1)
    upper = np.stack([corner, corner + side + 2, corner + side + 1], axis=1)
    moves = np.random.default_rng(seed).uniform(-0.24, 0.24, points.shape)
    moves[~np.logical_and(points > 0, points < side).all(axis=1)] = 0
    # A worker has a thread per core, so that the runs share the cores.
    result = gpu_smooth.run(points + moves, np.concatenate([lower, upper]), engine="cpu")
    return result.quality_after.min_angle


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--meshes", type=int, default=1000)
    parser.add_argument("--side", type=int, default=30)
    parser.add_argument("--scheduler")
    arguments = parser.parse_args()
    cluster = None if arguments.scheduler else LocalCluster(dashboard_address=None)
    with Client(arguments.scheduler or cluster) as client:
        count = arguments.meshes
        angles = client.gather(client.map(smoothed, range(count), [arguments.side] * count))
        print(f"{len(angles)} meshes, least angle {min(angles):.1f} degrees")
    if cluster is not None:
        cluster.close()


if __name__ == "__main__":
    main()
