#!/usr/bin/env python3
"""Runs gpu-smooth on random meshes of many kinds, and compares the remaining gain that each converged run reports with the gain of
a much longer run.

    cargo build --release
    python3 benches/remaining.py target/release/gpu-smooth [--runs N] [--seed K] [--engines cpu,gpu] [--before PROGRAM] [--all]

Prints a row for each run that leaves more than it reports (with --all, for each run), and counts. A run with a fixed boundary
continues from its result to a tolerance of 1e-12. Bounds of moves and curves belong to the given mesh, so such runs begin anew
with that tolerance. --before compares f, sweeps and times with another version of the program.
"""

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TWO_PI = 2 * math.pi


def lattice(columns, rows, at):
    """Triangles of a lattice with diagonals in one direction, and its points at(column, row)."""
    points = [at(i, j) for j in range(rows + 1) for i in range(columns + 1)]
    triangles = []
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 1, a + columns + 2
            triangles += [(a, b, d), (a, d, c)]
    return points, triangles


def shaken(rng, mesh, size):
    """Moves each vertex that has triangles all around at random, by a share of the distance to the opposite edges."""
    points, triangles = mesh
    ends, around = {}, {}
    for t in triangles:
        for k in range(3):
            edge = tuple(sorted((t[k], t[k - 1])))
            ends[edge] = ends.get(edge, 0) + 1
            around.setdefault(t[k], []).append((t[k - 2], t[k - 1]))
    held = {v for edge, count in ends.items() if count == 1 for v in edge}
    moved = list(points)
    for v, edges in around.items():
        if v in held:
            continue
        x, y = points[v]
        most = math.inf
        for a, b in edges:
            (ax, ay), (bx, by) = points[a], points[b]
            doubled = abs((bx - ax) * (y - ay) - (by - ay) * (x - ax))
            most = min(most, doubled / math.hypot(bx - ax, by - ay))
        way, turn = 0.5 * size * most * math.sqrt(rng.random()), TWO_PI * rng.random()
        moved[v] = (x + way * math.cos(turn), y + way * math.sin(turn))
    return moved, triangles


def plain(rng):
    n = rng.randint(6, 40)
    return shaken(rng, lattice(n, rng.randint(6, 40), lambda i, j: (i + j / 2, j * 0.866)), rng.uniform(0.2, 0.95))


def graded(rng):
    n, m = rng.randint(8, 40), rng.randint(8, 40)
    ratio = 10 ** rng.uniform(0.5, 4)
    y = lambda j: (ratio ** (j / m) - 1) / (ratio - 1) * n
    return shaken(rng, lattice(n, m, lambda i, j: (i, y(j))), rng.uniform(0, 0.8))


def stretched(rng):
    n = rng.randint(8, 40)
    by = 10 ** rng.uniform(0.3, 2.5)
    points, triangles = shaken(rng, lattice(n, n, lambda i, j: (i + j / 2, j * 0.866)), rng.uniform(0.1, 0.8))
    return [(x, y / by) for x, y in points], triangles


def hub(rng):
    """Rings around a vertex of many neighbors."""
    spokes, rings = rng.choice([20, 30, 50, 100, 200]), rng.randint(3, 14)
    ratio = rng.uniform(1.0, 1.25)
    radii = [ratio**k * (1 + k * 0.3) for k in range(rings)]
    points = [(0.0, 0.0)]
    for k, radius in enumerate(radii):
        points += [(radius * math.cos(TWO_PI * (s + k / 2) / spokes), radius * math.sin(TWO_PI * (s + k / 2) / spokes)) for s in range(spokes)]
    at = lambda k, s: 1 + k * spokes + s % spokes
    triangles = [(0, at(0, s), at(0, s + 1)) for s in range(spokes)]
    for k in range(rings - 1):
        for s in range(spokes):
            triangles += [(at(k, s), at(k + 1, s), at(k, s + 1)), (at(k, s + 1), at(k + 1, s), at(k + 1, s + 1))]
    return shaken(rng, (points, triangles), rng.uniform(0, 0.7))


def waves(rng):
    n = rng.randint(10, 40)
    amplitude, turns = rng.uniform(0.02, 0.12), rng.randint(1, 4)

    def at(i, j):
        x, y = i / n, j / n
        bump = amplitude * math.sin(turns * math.pi * x) * math.sin(math.pi * y)
        return x + bump / turns, y + bump / turns

    return shaken(rng, lattice(n, n, at), rng.uniform(0, 0.5))


def channel(rng):
    """A channel with wavy walls, whose vertices are unevenly spaced along the walls."""
    n, m = rng.randint(20, 70), rng.randint(6, 16)
    height, turns, uneven = rng.uniform(0, 0.25), rng.randint(1, 4), rng.uniform(0, 0.6)

    def at(i, j):
        x, y = 4 * (i / n + uneven / TWO_PI / 2 * math.sin(TWO_PI * i / n)), j / m
        wall = 1 + height * math.sin(turns * math.pi * x / 2)
        return x, y * wall

    return shaken(rng, lattice(n, m, at), rng.uniform(0, 0.7))


def ring(rng):
    """A ring whose inner and outer boundaries are turned against each other."""
    n, m = rng.randint(24, 90), rng.randint(4, 16)
    twist, jag = rng.uniform(0, 1.0), rng.uniform(0, 0.02)

    def at(i, j):
        radius = 1 + 1.5 * j / m
        turn = TWO_PI * i / n + twist * j / m
        radius *= 1 + jag * math.sin(7 * turn)
        return radius * math.cos(turn), radius * math.sin(turn)

    points, triangles = lattice(n, m, at)
    first = {j * (n + 1) + n: j * (n + 1) for j in range(m + 1)}
    triangles = [tuple(first.get(v, v) for v in t) for t in triangles]
    number = {v: k for k, v in enumerate(v for v in range(len(points)) if v not in first)}
    mesh = [points[v] for v in number], [tuple(number[v] for v in reversed(t)) for t in triangles]
    return shaken(rng, mesh, rng.uniform(0, 0.6))


KINDS = {f.__name__: f for f in (plain, graded, stretched, hub, waves, channel, ring)}

# Name, options, whether a longer run continues from OUT, and kinds of meshes (None for all).
CASES = [
    ("imr", [], True, None),
    ("imr to 1e-4", ["--tolerance", "1e-4"], True, None),
    ("rms", ["--scheme", "rms"], True, None),
    ("shape-size", ["--scheme", "shape-size"], True, ["plain", "waves", "channel", "ring"]),
    ("edge", ["--scheme", "edge"], True, ["plain", "waves", "channel", "ring"]),
    ("relaxed", ["--method", "relaxed"], True, ["plain", "graded", "waves", "channel"]),
    ("keep-shape", ["--target", "keep-shape"], None, None),
    ("keep-size", ["--target", "keep-size"], None, ["plain", "graded", "waves", "channel", "ring"]),
    ("slide", ["--slide"], None, ["plain", "waves", "channel", "ring", "graded"]),
    ("max-move", ["--max-move", "0.3"], None, None),
    ("keep-altitude", ["--keep-altitude"], None, None),
    ("alternating", ["--scheme", "imr+rms"], True, ["plain", "graded", "waves", "channel"]),
]


def write(stem, mesh):
    points, triangles = mesh
    with open(f"{stem}.node", "w") as out:
        print(len(points), 2, 0, 0, file=out)
        for k, (x, y) in enumerate(points, 1):
            print(k, repr(x), repr(y), file=out)
    with open(f"{stem}.ele", "w") as out:
        print(len(triangles), 3, 0, file=out)
        for k, t in enumerate(triangles, 1):
            print(k, *(v + 1 for v in t), file=out)


def run(program, source, result, options):
    """Returns the report of a run and its seconds; a text if the program refuses the run."""
    report = result.with_suffix(".json")
    command = [program, f"{source}.node", f"{result}.node", "--force", "--quiet", "--keep-layers", "none", "--report", report, *options]
    began = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    if done.returncode not in (0, 3):
        return done.stderr.strip().splitlines()[0] if done.stderr else str(done.returncode), 0.0
    return json.loads(report.read_text()), time.monotonic() - began


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--engines", default="cpu")
    parser.add_argument("--before")
    parser.add_argument("--only", help="names of cases, with commas between")
    parser.add_argument("--all", action="store_true")
    args = parser.parse_args()
    cases = [case for case in CASES if not args.only or case[0] in args.only.split(",")]
    counts, worse = {}, []
    with tempfile.TemporaryDirectory() as folder:
        stem = Path(folder)
        for k in range(args.runs):
            rng = random.Random(1_000_003 * args.seed + k)
            name, options, continues, kinds = cases[k % len(cases)]
            kind = rng.choice(kinds or list(KINDS))
            write(stem / "in", KINDS[kind](rng))
            engine = args.engines.split(",")[k // len(cases) % len(args.engines.split(","))]
            report, seconds = run(args.program, stem / "in", stem / "out", [*options, "--engine", engine])
            if isinstance(report, str):
                print(f"{k:4} {kind:9} {name}: refused: {report}", flush=True)
                continue
            count = counts.setdefault((engine, name), {"runs": 0, "converged": 0, "above": 0, "twice": 0, "ten": 0, "sweeps": 0, "iterations": 0, "seconds": 0.0, "most": 0.0})
            count["runs"] += 1
            count["sweeps"] += report["sweeps"]
            count["iterations"] += report.get("newton_iterations", 0)
            count["seconds"] += report["seconds"]["smooth"]
            f = report["movable_f"][1]
            if args.before:
                old, _ = run(args.before, stem / "in", stem / "old", [*options, "--engine", engine])
                if not isinstance(old, str):
                    count["old sweeps"] = count.get("old sweeps", 0) + old["sweeps"]
                    count["old seconds"] = count.get("old seconds", 0.0) + old["seconds"]["smooth"]
                    tolerance = 1e-4 if "1e-4" in options else 1e-6
                    if f > old["movable_f"][1] * (1 + tolerance):
                        worse.append(f"{k:4} {kind:9} {name:13} f {f:.8f}, before {old['movable_f'][1]:.8f} ({f / old['movable_f'][1] - 1:.1e}), {report['stop']} after {report['sweeps']}, before {old['stop']} after {old['sweeps']}")
            if report["stop"] != "converged":
                continue
            count["converged"] += 1
            longer = [*options, "--tolerance", "1e-12", "--max-sweeps", "20000", "--engine", "cpu"]
            if continues and "--tolerance" in options:
                longer = longer[2:]
            start = stem / ("out" if continues else "in")
            end, _ = run(args.program, start, stem / "end", longer)
            if isinstance(end, str):
                print(f"{k:4} {kind:9} {name}: the longer run is refused: {end}", flush=True)
                continue
            left = max(0.0, (f - end["movable_f"][1]) / f)
            ratio = left / max(report["remaining"] or 0.0, 1e-300)
            count["above"] += ratio > 1
            count["twice"] += ratio > 2
            count["ten"] += ratio > 10
            count["most"] = max(count["most"], ratio)
            if ratio > 1 or args.all:
                print(f"{k:4} {engine} {kind:9} {name:13} {report['sweeps']:5} sweeps, reported {report['remaining']:.1e}, left {left:.1e}: {ratio:.2f}", flush=True)
    print("\n| engine, options | runs | converged | above the report | above twice | above ten times | most | sweeps | iterations | s |" + (" sweeps before | s before |" if args.before else ""))
    print("|---|---|---|---|---|---|---|---|---|---|" + ("---|---|" if args.before else ""))
    for (engine, name), c in sorted(counts.items()):
        row = [f"{engine}, {name}", c["runs"], c["converged"], c["above"], c["twice"], c["ten"], f"{c['most']:.2f}", c["sweeps"], c["iterations"], f"{c['seconds']:.2f}"]
        if args.before:
            row += [c.get("old sweeps", "-"), f"{c.get('old seconds', 0):.2f}"]
        print("| " + " | ".join(map(str, row)) + " |")
    if worse:
        print("\nf higher than before by more than the tolerance:")
        print("\n".join(worse))


if __name__ == "__main__":
    sys.exit(main())
