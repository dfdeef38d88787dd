"""Smooths the meshes of a directory in a Slurm job array: task k of n smooths the meshes k, k + n, k + 2 n and so on.

Submit: sbatch --array=0-15 --cpus-per-task=4 --wrap "RAYON_NUM_THREADS=4 python slurm_array.py meshes smoothed"
Without Slurm, the only task smooths all meshes: python slurm_array.py meshes smoothed
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

import gpu_smooth


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path, help="directory of meshes")
    parser.add_argument("destination", type=Path, help="directory for the smoothed meshes")
    arguments = parser.parse_args()
    source, destination = arguments.source, arguments.destination
    destination.mkdir(parents=True, exist_ok=True)
    task = int(os.environ.get("SLURM_ARRAY_TASK_ID", 0)) - int(os.environ.get("SLURM_ARRAY_TASK_MIN", 0))
    tasks = int(os.environ.get("SLURM_ARRAY_TASK_COUNT", 1))
    failures = 0
    for mesh in sorted(path for path in source.iterdir() if path.is_file())[task::tasks]:
        try:
            report = gpu_smooth.smooth_file(mesh, destination / mesh.name, engine="cpu")
            print(f"{mesh.name}: {report['after']['min_angle']:.1f} degrees")
        except gpu_smooth.GpuSmoothError as error:
            failures += 1
            print(f"{mesh.name}: {error}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
