#!/usr/bin/env python3
"""Makes adapted meshes with gmsh and Mmg, runs gpu-smooth on them with the targets that keep sizes and shapes, and prints
the table "Adapted meshes" of docs/targets.md.

    pip install gmsh mmgpy numpy                # tried with 4.15 and 0.17
    cargo build --release
    python3 benches/adapted.py target/release/gpu-smooth [MESH...]

Mmg adapts each mesh four times to tensors: layers along curves (shocks, walls, wakes), across which triangles are stretched
as many times as the name says, and disks (vortices). Each MESH is a further mesh in a format of gpu-smooth.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import gmsh
import numpy as np

# The airfoil NACA 0012, from the nose over the upper side.
ALONG = 0.5 * (1 - np.cos(np.linspace(0, np.pi, 120)))
THICKNESS = 0.6 * (0.2969 * np.sqrt(ALONG) - 0.126 * ALONG - 0.3516 * ALONG**2 + 0.2843 * ALONG**3 - 0.1036 * ALONG**4)
FOIL = np.concatenate([np.stack([ALONG, THICKNESS], 1), np.stack([ALONG, -THICKNESS], 1)[-2:0:-1]])
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
BOX = [(-3, -3), (5, -3), (5, 3), (-3, 3)]


def closed(points, size):
    """Adds a closed polygon to the model of gmsh, and returns its lines."""
    geo = gmsh.model.geo
    tags = [geo.addPoint(x, y, 0, size) for x, y in points]
    return [geo.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1])]


def by_gmsh(outer, size, foil_size=None, layer=False):
    """Meshes a polygon, with an airfoil as a hole and a boundary layer around it if asked."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geo = gmsh.model.geo
    loops = [geo.addCurveLoop(closed(outer, size))]
    if foil_size:
        lines = closed(FOIL, foil_size)
        loops.append(geo.addCurveLoop(lines))
        if layer:
            field = gmsh.model.mesh.field
            tag = field.add("BoundaryLayer")
            field.setNumbers(tag, "CurvesList", lines)
            for name, value in [("Size", 5e-4), ("Ratio", 1.3), ("Thickness", 0.04), ("Quads", 0)]:
                field.setNumber(tag, name, value)
            field.setAsBoundaryLayer(tag)
    geo.addPlaneSurface(loops)
    geo.synchronize()
    gmsh.model.mesh.generate(2)
    tags, points, _ = gmsh.model.mesh.getNodes()
    number = {tag: i for i, tag in enumerate(tags)}
    cells = [np.array([number[tag] for tag in gmsh.model.mesh.getElements(d)[2][0]]) for d in (2, 1)]
    triangles, edges = cells[0].reshape(-1, 3), cells[1].reshape(-1, 2)
    points = points.reshape(-1, 3)[:, :2]
    gmsh.finalize()
    used = np.unique(triangles)
    new = np.full(len(points), -1)
    new[used] = np.arange(len(used))
    return points[used], new[triangles], new[edges]


def write(path, points, triangles, edges):
    with open(path, "w") as out:
        print(f"MeshVersionFormatted 2\nDimension 2\nVertices\n{len(points)}", file=out)
        print(*(f"{x!r} {y!r} 0" for x, y in points.tolist()), sep="\n", file=out)
        if len(edges):
            print(f"Edges\n{len(edges)}", file=out)
            print(*(f"{a + 1} {b + 1} 1" for a, b in edges), sep="\n", file=out)
        print(f"Triangles\n{len(triangles)}", file=out)
        print(*(f"{a + 1} {b + 1} {c + 1} 1" for a, b, c in triangles), sep="\n", file=out)
        print("End", file=out)


def read(path):
    words, blocks, at = Path(path).read_text().split(), {}, 0
    widths = {"Vertices": 3, "Edges": 3, "Triangles": 4}
    while at < len(words):
        if (width := widths.get(words[at])) is None:
            at += 1
            continue
        count = int(words[at + 1])
        block = np.array(words[at + 2 : at + 2 + count * width], float).reshape(count, width)
        blocks[words[at]] = block[:, :-1]
        at += 2 + count * width
    cells = [blocks.get(name, np.empty((0, 1))).astype(int) - 1 for name in ("Triangles", "Edges")]
    return blocks["Vertices"], *cells


def tensors(normal, across, along):
    normal = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    tangent = np.stack([-normal[:, 1], normal[:, 0]], 1)
    outer = lambda v, size: v[:, :, None] * v[:, None, :] / (size * size)[:, None, None]
    return outer(normal, across) + outer(tangent, along)


def both(first, second):
    """Returns the intersection of tensors: the smaller size in each direction."""
    values, vectors = np.linalg.eigh(first)
    to = (vectors * np.sqrt(values)[:, None, :]) @ vectors.transpose(0, 2, 1)
    back = np.linalg.inv(to)
    values, vectors = np.linalg.eigh(back @ second @ back)
    most = (vectors * np.maximum(values, 1)[:, None, :]) @ vectors.transpose(0, 2, 1)
    return to @ most @ to


def layer(distance, normal, along, stretching, growth=0.4):
    return tensors(normal, np.minimum(along, along / stretching + growth * np.abs(distance)), along)


def shock(points, stretching, size=0.06):
    x, y = points.T
    normal = np.stack([np.ones_like(x), -0.45 * np.cos(3 * y)], 1)
    distance = (x - 0.4 - 0.15 * np.sin(3 * y)) / np.linalg.norm(normal, axis=1)
    return layer(distance, normal, np.full(len(x), size), stretching)


def several(points, stretching, size=0.06):
    along = np.full(len(points), size)
    wall = layer(points[:, 1], np.tile([0.0, 1.0], (len(points), 1)), along, stretching)
    spoke = points - [0.2, 0.9]
    circle = layer(np.linalg.norm(spoke, axis=1) - 0.5, spoke, along, stretching)
    found = both(both(shock(points, stretching), wall), circle)
    for center in [(0.75, 0.6), (0.8, 0.25)]:
        away = np.maximum(np.linalg.norm(points - center, axis=1) - 0.02, 0)
        found = both(found, np.eye(2) / (np.minimum(size, size / 5 + 0.4 * away) ** 2)[:, None, None])
    return found


def around_foil(points, stretching, far=0.5, near=0.03):
    best, normal = np.full(len(points), np.inf), np.zeros_like(points)
    for a, b in zip(FOIL, np.roll(FOIL, -1, 0)):
        edge = b - a
        to = points - a - np.clip((points - a) @ edge / (edge @ edge), 0, 1)[:, None] * edge
        distance = np.linalg.norm(to, axis=1)
        closer = distance < best
        best[closer] = distance[closer]
        at_wall = np.tile([-edge[1], edge[0]], (len(points), 1)) / np.linalg.norm(edge)
        unit = np.where(distance[:, None] > 1e-9, to / np.maximum(distance, 1e-30)[:, None], at_wall)
        normal[closer] = unit[closer]
    along = np.minimum(far, near + 0.4 * best)
    found = tensors(normal, np.minimum(far, near / stretching + 0.4 * best), along)
    x, y = points.T
    for side in (1, -1):
        on = (side * y > 0) & (side * y < 1)
        size = np.where(on, 0.08 + 0.3 * np.maximum(0, np.abs(y) - 0.8), far)
        slope = np.stack([np.ones_like(x), np.full_like(x, -0.3 * side)], 1)
        across = np.minimum(size, size / stretching + 0.4 * np.abs(x - 0.6 - 0.3 * side * y))
        found = both(found, tensors(slope, np.where(on, across, far), size))
    size = np.where(x > 1, np.minimum(far, 0.1 + 0.1 * (x - 1)), far)
    across = np.where(x > 1, np.minimum(size, size / stretching + 0.4 * np.abs(y)), far)
    return both(found, tensors(np.tile([0.0, 1.0], (len(x), 1)), across, size))


def adapted(folder, start, metric, stretching, gradation=None):
    mesh = start
    for _ in range(4):
        write(folder / "start.mesh", *mesh)
        with open(folder / "start.sol", "w") as out:
            print(f"MeshVersionFormatted 2\nDimension 2\nSolAtVertices\n{len(mesh[0])}\n1 3", file=out)
            rows = metric(mesh[0], stretching)
            print(*(f"{m[0, 0]!r} {m[0, 1]!r} {m[1, 1]!r}" for m in rows.astype(object)), sep="\n", file=out)
            print("End", file=out)
        command = ["mmg2d_O3", "-in", folder / "start.mesh", "-sol", folder / "start.sol", "-out", folder / "adapted.mesh", "-v", "0"]
        command += ["-hgrad", str(gradation)] if gradation else []
        subprocess.run(command, check=True, capture_output=True)
        mesh = read(folder / "adapted.mesh")
    return mesh


def rows_at_wall(around, rows, first, growth, noise, seed=1):
    """Makes a layer of rows at the outside of a half circle, each square cut along a random diagonal."""
    rng = np.random.default_rng(seed)
    heights = np.concatenate([[0], np.cumsum(first * growth ** np.arange(rows))])
    points, triangles = [], []
    for j in range(rows + 1):
        gap = min(heights[j] - heights[j - 1] if j else 0, heights[j + 1] - heights[j] if j < rows else 0)
        for i in range(around + 1):
            along, up = noise * rng.uniform(-1, 1, 2) if 0 < j < rows and 0 < i < around else (0, 0)
            angle, radius = np.pi * (1 - (i + along) / around), 1 + heights[j] + up * gap
            points.append((radius * np.cos(angle), radius * np.sin(angle)))
    for j in range(rows):
        for i in range(around):
            a = j * (around + 1) + i
            b, c, d = a + 1, a + around + 1, a + around + 2
            triangles += [(a, d, b), (a, c, d)] if rng.integers(2) else [(a, c, b), (b, c, d)]
    return np.array(points), np.array(triangles), np.empty((0, 2), int)


def made(folder):
    square, foil = by_gmsh(SQUARE, 0.05), by_gmsh(BOX, 0.4, 0.02)
    yield "airfoil, graded (gmsh)", foil
    yield "airfoil, boundary layer (gmsh)", by_gmsh(BOX, 0.4, 0.02, layer=True)
    for stretching in (1, 3, 5, 8, 12, 20):
        yield f"airfoil, wall, shocks and wake, {stretching}", adapted(folder, foil, around_foil, stretching)
    for stretching in (3, 5, 8, 12, 20):
        yield f"shocks, vortices and wall, {stretching}", adapted(folder, square, several, stretching)
    yield "the same, growing faster, 20", adapted(folder, square, several, 20, gradation=3)
    for stretching in (3, 5, 8, 12, 20):
        yield f"shock, {stretching}", adapted(folder, square, shock, stretching)
    yield "rows at a curved wall, 20", rows_at_wall(80, 20, 1.6e-3, 1.2, 0.1)
    yield "rows at a curved wall, 200", rows_at_wall(120, 40, 1e-4, 1.15, 0.05)


def spacing(report):
    """Returns the largest factor by which the vertex next to a wall changes its distance from the wall."""
    return max((max(wall["ratios"][2], 1 / wall["ratios"][0]) for wall in report["spacing"]), default=1.0)


def measured(program, mesh, folder, *options):
    out, report = folder / f"out{mesh.suffix}", folder / "report.json"
    command = [program, mesh, out, "--engine", "cpu", "--report", report, "--force", "-q", *options]
    subprocess.run([*map(str, command)], check=True)
    return json.loads(report.read_text())


def row(program, name, mesh, folder):
    sized = measured(program, mesh, folder, "--target", "keep-size", "--keep-layers", "none")
    weight = sized["target"]["size_weight"]
    stretching = f"{2.5 + 2 * (weight - 1):.1f}" if weight > 1 else "below 2.5"
    cells = [name, sized["mesh"]["vertices"], stretching, f"{weight:.1f}"]
    f = [sized[when]["f"]["imr"] for when in ("before", "after")]
    cells += [f"{f[0]:.3f}", f"{f[1]:.3f}", f"{sized['change']['size']['p95']:.2f}", sized["sweeps"]]
    stops = [sized["stop"]]
    for options in (["--keep-layers", "none"], []):
        shaped = measured(program, mesh, folder, "--target", "keep-shape", *options)
        cells.append(f"{spacing(shaped):.2f}")
    cells.append(shaped["sweeps"])
    stops.append(shaped["stop"])
    # Runs that did not converge are named behind the row.
    print("|", " | ".join(map(str, cells)), "|", *(stop for stop in stops if stop != "converged"))


def main():
    program = sys.argv[1]
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name, mesh in made(folder):
            write(folder / "in.mesh", *mesh)
            row(program, name, folder / "in.mesh", folder)
        for mesh in map(Path, sys.argv[2:]):
            row(program, mesh.name, mesh, folder)


main()
