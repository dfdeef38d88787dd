#!/usr/bin/env python3
"""Tries gpu-smooth on a folder of real meshes, and prints the table "Tried with" of docs/formats.md.

    cargo build --release
    benches/real_meshes.py target/release/gpu-smooth FOLDER

Of each mesh three things are demanded: with `--max-sweeps 0` it comes back byte for byte; it is smoothed on the CPU or refused with
a reason; and `gpu-smooth compare` of what was smoothed finds nothing but moved vertices. The exit code is 1 if one of these does
not hold. The folder's manifest.json, if there is one, tells of each mesh: "file", the "repo" it is from, and a "note".
"""

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Files that are not meshes by themselves: those that belong to a .node, and descriptions.
BESIDE = {".ele", ".poly", ".json", ".md", ".txt"}


def run(program, *arguments):
    command = [program, *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def contents(path):
    """Returns the bytes of a mesh's files, by the endings of their names."""
    return {beside.suffix: beside.read_bytes() for beside in path.parent.glob(path.stem + ".*")
            if path.suffix == ".node" or beside == path}


def tried(program, mesh, folder):
    """Returns the result as text, the name of the format, and whether all checks passed."""
    same = folder / "same" / mesh.name
    moved = folder / "moved" / mesh.name
    for path in (same, moved):
        path.parent.mkdir(exist_ok=True)
    groups = run(program, "groups", mesh)
    found = re.search(r": ([^:\n]+)$", groups.stdout.splitlines()[0]) if groups.stdout else None
    name = found.group(1) if found else "?"
    unmoved = run(program, mesh, same, "--engine", "cpu", "--max-sweeps", 0)
    smoothed = run(program, mesh, moved, "--engine", "cpu")
    if smoothed.returncode:
        errors = (line for line in smoothed.stderr.splitlines() if "error: " in line)
        reason = next(errors, smoothed.stderr.strip()).split("error: ", 1)[-1]
        reason = reason.removeprefix(f"{mesh}: ").split(". ")[0]
        untangled = run(program, mesh, moved, "--engine", "cpu", "--untangle")
        result = "smoothed with `--untangle`; without it " if untangled.returncode == 0 else ""
        # The reason must be on a line that names the mesh.
        told = smoothed.returncode in (1, 2) and str(mesh) in smoothed.stderr
        return f"{result}refused: {reason}", name, told
    if unmoved.returncode or contents(same) != contents(mesh):
        return "does not come back byte for byte", name, False
    compared = run(program, "compare", mesh, moved)
    if compared.returncode:
        return f"compare: {compared.stderr.strip() or compared.stdout.strip()}", name, False
    return "smoothed", name, True


def origins(folder):
    manifest = folder / "manifest.json"
    if not manifest.exists():
        return {}
    return {entry["file"]: entry for entry in json.loads(manifest.read_text())}


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, folder = sys.argv[1], Path(sys.argv[2])
    told = origins(folder)
    meshes = sorted(path for path in folder.iterdir() if path.is_file() and path.suffix not in BESIDE)
    all_hold = True
    print("| format | mesh | from | result |\n|---|---|---|---|")
    for mesh in meshes:
        with tempfile.TemporaryDirectory() as temporary:
            result, name, holds = tried(program, mesh, Path(temporary))
        entry = told.get(mesh.name, {})
        note = entry.get("note") or f"`{mesh.name}`"
        repository = entry.get("repo", "–").removeprefix("github.com/")
        print(f"| {name} | {note} | {repository} | {result} |", flush=True)
        all_hold &= holds
    sys.exit(0 if all_hold else 1)


if __name__ == "__main__":
    main()
