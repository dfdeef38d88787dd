"""Smooths the meshes of a directory in a Slurm job array: task k of n smooths the meshes k, k + n, k + 2 n and so on.

Submit: sbatch --array=0-15 --cpus-per-task=4 --wrap "RAYON_NUM_THREADS=4 python slurm_array.py meshes smoothed"
The numbers of the tasks may have any equal steps, as in --array=0-30:2.
Without Slurm, the only task smooths all meshes: python slurm_array.py meshes smoothed
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

import gpu_smooth


def meshes_of(directory: Path) -> list[Path]:
    """Return the meshes of a directory, each once: a mesh of Triangle is its .node, and has an .ele and perhaps a .poly beside it."""
    files = sorted(path for path in directory.iterdir() if path.is_file())
    of_triangle = {path.with_suffix("") for path in files if path.suffix.lower() == ".node"}
    beside = (".ele", ".poly")
    return [path for path in files if path.suffix.lower() not in beside or path.with_suffix("") not in of_triangle]


def place_of_task() -> tuple[int, int]:
    """Return the place of this task among the tasks of the job array, and the number of tasks; without Slurm, (0, 1)."""
    number, first, step, count = (
        int(os.environ.get(f"SLURM_ARRAY_TASK_{name}", default))
        for name, default in (("ID", 0), ("MIN", 0), ("STEP", 1), ("COUNT", 1))
    )
    last = int(os.environ.get("SLURM_ARRAY_TASK_MAX", first + (count - 1) * step))
    place, rest = divmod(number - first, step)
    if rest or (last - first) // step + 1 != count:
        raise SystemExit("the numbers of the tasks need equal steps, as in --array=0-15 and --array=0-30:2")
    return place, count


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("source", type=Path, help="directory of meshes")
    parser.add_argument("destination", type=Path, help="directory for the smoothed meshes")
    arguments = parser.parse_args()
    source, destination = arguments.source, arguments.destination
    destination.mkdir(parents=True, exist_ok=True)
    task, tasks = place_of_task()
    failures = 0
    for mesh in meshes_of(source)[task::tasks]:
        try:
            report = gpu_smooth.smooth_file(mesh, destination / mesh.name, engine="cpu")
            print(f"{mesh.name}: {report['after']['min_angle']:.1f} degrees")
        except gpu_smooth.GpuSmoothError as error:
            failures += 1
            print(f"{mesh.name}: {error}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
