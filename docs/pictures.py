#!/usr/bin/env python3
"""Makes the pictures of the documents again, but those of docs/paper.md and docs/performance.md, which name their commands.

    pip install pillow
    cargo build --release -p gpu-smooth-cli && cargo build --release -p gpu-smooth-examples --example make_mesh --example live
    docs/pictures.py target/release/gpu-smooth target/release/examples chromium [MESHES]

MESHES is a folder with meshes whose pictures are left out without the folder. It has those of docs/targets.md:

- corie_hgrid.gr3: examples/Exp3_CORIE_LSC2/inputs/hgrid.gr3 of github.com/wenfanwu/schism-toolbox
- naca0012_inv.su2: cont_adj_euler/naca0012/mesh_NACA0012_inv.su2 of github.com/su2code/TestCases
- multi-mat.mesh: libexamples/mmg2d/IsosurfDiscretization_lsOnly/multi-mat.mesh of github.com/MmgTools/mmg

and with naca0012_lam_hybrid.su2 of docs/guide.md: navierstokes/naca0012/mesh_NACA0012_lam_hybrid_v1.su2 of the same repository as the other
airfoil.

Pictures have palettes of few colors, as each version of a picture stays in the repository.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile

from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"

# Vertices of the lattice of docs/guide.md, 4 by 4, of which the inner ones are displaced.
DISPLACED = {
    (1, 1): (0.409602, 0.373708),
    (2, 1): (0.662776, 0.228022),
    (1, 2): (0.203451, 0.622333),
    (2, 2): (0.658933, 0.647530),
}

# Pictures of docs/targets.md: mesh, and two opposite corners of the drawn part.
TARGETS = {
    "targets-ocean.png": ("corie_hgrid.gr3", "-123.82,46.19,-123.66,46.29"),
    "targets-airfoil.png": ("naca0012_inv.su2", "-0.2,-0.32,0.55,0.32"),
    "targets-part.png": ("multi-mat.mesh", "0.62,0.22,0.92,0.48"),
}

# The pointer rests on a triangle of the second view.
POINTER = """<script>
const shown = canvases[1].getBoundingClientRect();
tell(canvases[1], { clientX: shown.left + 0.78 * shown.width, clientY: shown.top + 0.4 * shown.height });
</script></body>"""


def main():
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    program, examples = (pathlib.Path(name).resolve() for name in sys.argv[1:3])
    make_mesh = examples / "make_mesh"
    browser = sys.argv[3]
    meshes = pathlib.Path(sys.argv[4]).resolve() if len(sys.argv) == 5 else None
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)

        def run(*words):
            subprocess.run([str(word) for word in words], cwd=folder, check=True, stdout=subprocess.DEVNULL)

        for name in ("plate.node", "plate.ele"):
            shutil.copy(ROOT / "meshes" / name, folder)
        plate = (program, "plate.node", "out.node", "--engine", "cpu", "--force")
        run(*plate, "--picture", "plate.png", "--picture-size", "860")
        save(folder / "plate.png", 160)
        run(*plate, "--html", "page.html")
        save(screenshot(run, browser, folder / "page.html"), 160, "report.png")
        recipe = ("--vertices", "600", "--tangle", "turn", "--seed", "3")
        run(make_mesh, ROOT / "meshes/plate.outline", "turned", *recipe)
        run(program, "turned.node", "out.node", "--untangle", "--force", "--picture", "untangled.png", "--picture-size", "800")
        save(folder / "untangled.png", 160)
        run(make_mesh, ROOT / "meshes/plate.outline", "coarse", "--vertices", "700")
        script = ROOT / "examples/live/moving-hole.script"
        run(examples / "live", "coarse.node", "--script", script, "--out", folder, "--headless", "--size", "640x560")
        save_frames(sorted(folder.glob("[0-9][0-9].png")), "moving-hole.png")
        write_lattice(folder / "lattice")
        sweep = ("--engine", "cpu", "--max-sweeps", "1", "--force", "--picture-size", "400", "--picture-measure", "imr")
        run(program, "lattice.node", "out.node", *sweep, "--picture", "sweep.svg")
        shutil.copy(folder / "sweep.svg", DOCS)
        write_paved(folder / "coarse", folder / "part.off")
        run(program, "part.off", "paved.off", "--engine", "cpu", "--force", "--picture", "paved.png", "--picture-size", "860")
        save(folder / "paved.png", 160)
        if meshes:
            shutil.copy(meshes / "naca0012_lam_hybrid.su2", folder / "airfoil.su2")
            part = ("--picture", "hybrid.png", "--picture-size", "860", "--picture-box=-0.15,-0.3,0.45,0.3")
            run(program, "airfoil.su2", "out.su2", "--engine", "cpu", "--force", *part)
            save(folder / "hybrid.png", 160)
            for name, (mesh, part) in TARGETS.items():
                save(by_target(run, program, folder, meshes / mesh, part), 160, name)


def save(path, colors, name=None):
    """Writes a picture to docs with a palette of at most `colors` colors."""
    picture = Image.open(path).convert("RGB")
    palette = picture.quantize(colors, method=Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    palette.save(DOCS / (name or path.name), optimize=True)


def save_frames(paths, name):
    """Writes the meshes of screenshots of examples/live to docs as a moving picture, without the panel above the mesh."""
    frames = [Image.open(path).convert("RGB").crop((50, 185, 590, 550)) for path in paths]
    palette = frames[0].quantize(24, dither=Image.Dither.NONE)
    first, *others = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    first.save(DOCS / name, save_all=True, append_images=others, duration=90, loop=0, optimize=True)


def screenshot(run, browser, page):
    """Draws the upper part of a page, which has neither times nor names of files, with the pointer on the mesh."""
    page.write_text(page.read_text().replace("</body>", POINTER))
    flags = ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--blink-settings=preferredColorScheme=1")
    run(browser, *flags, "--window-size=1200,1430", "--screenshot=page.png", page.as_uri())
    return page.with_name("page.png")


def write_lattice(stem):
    """Writes the lattice with alternating diagonals as Triangle files."""
    at = lambda i, j: 4 * j + i + 1
    rows = []
    for j in range(4):
        for i in range(4):
            x, y = DISPLACED.get((i, j), (i / 3, 0.29 * j))
            rows.append(f"{at(i, j)} {x:.6f} {y:.6f}")
    triangles = []
    for j in range(3):
        for i in range(3):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            triangles += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    lines = [f"{k} {a} {b} {c}" for k, (a, b, c) in enumerate(triangles, 1)]
    stem.with_suffix(".node").write_text("\n".join(["16 2 0 0", *rows]) + "\n")
    stem.with_suffix(".ele").write_text("\n".join(["18 3 0", *lines]) + "\n")


def write_paved(stem, path):
    """Joins triangles of a Triangle mesh in pairs to quadrilaterals, the most square pairs first, and writes an OFF."""
    words = lambda ending: [line.split() for line in stem.with_suffix(ending).read_text().splitlines()]
    rows = [row for row in words(".node") if row and row[0] != "#"]
    points = [tuple(map(float, row[1:3])) for row in rows[1:]]
    first = int(rows[1][0])
    rows = [row for row in words(".ele") if row and row[0] != "#"]
    triangles = [tuple(int(word) - first for word in row[1:4]) for row in rows[1:]]
    sides = {}
    for k, t in enumerate(triangles):
        for i in range(3):
            sides[t[i], t[(i + 1) % 3]] = (k, t[(i + 2) % 3])
    pairs = []
    for (a, b), (k, c) in sides.items():
        if a < b and (b, a) in sides:
            other, d = sides[b, a]
            quadrilateral = (a, d, b, c)
            corners = [tuple(points[quadrilateral[(i + j) % 4]] for j in (0, 1, 3)) for i in range(4)]
            edges = [((q[0] - p[0], q[1] - p[1]), (r[0] - p[0], r[1] - p[1])) for p, q, r in corners]
            areas = [u[0] * v[1] - u[1] * v[0] for u, v in edges]
            if min(areas) > 0:
                worst = max((u[0] ** 2 + u[1] ** 2 + v[0] ** 2 + v[1] ** 2) / (2 * area) for (u, v), area in zip(edges, areas))
                pairs.append((worst, k, other, quadrilateral))
    used, faces = set(), []
    for worst, k, other, quadrilateral in sorted(pairs):
        if worst < 2 and k not in used and other not in used:
            used |= {k, other}
            faces.append(quadrilateral)
    faces += [t for k, t in enumerate(triangles) if k not in used]
    lines = ["OFF", f"{len(points)} {len(faces)} 0"]
    lines += [f"{x!r} {y!r} 0" for x, y in points]
    lines += [" ".join(map(str, (len(face), *face))) for face in faces]
    path.write_text("\n".join(lines) + "\n")


def by_target(run, program, folder, mesh, part):
    """Draws a part of a mesh before smoothing and after smoothing by each target, side by side above one legend."""
    shutil.copy(mesh, folder / f"before{mesh.suffix}")
    names = ["before", "equilateral", "keep-size", "keep-shape"]
    options = ("--picture-measure", "imr", "--picture-size", "400", f"--picture-box={part}")
    pictures = []
    for name in names:
        if name != "before":
            run(program, f"before{mesh.suffix}", f"{name}{mesh.suffix}", "--engine", "cpu", "--target", name)
        run(program, "quality", f"{name}{mesh.suffix}", "--picture", f"{name}.png", *options)
        pictures.append(Image.open(folder / f"{name}.png").convert("RGB"))
    views = [cut(picture) for picture in pictures]
    width, height = views[0][0].size
    legend = views[0][1]
    whole = Image.new("RGB", (width * len(views), height + legend.height), "white")
    for i, (view, _) in enumerate(views):
        whole.paste(view, (i * width, 0))
    whole.paste(legend, (0, height))
    path = folder / "targets.png"
    whole.save(path)
    return path


def cut(picture):
    """Returns the view and the legend of a picture of a part. Enlarged triangles between them are left out."""
    text = 11
    width, height = picture.size
    # The frames of the view and of enlarged triangles are lines at the left margin.
    is_line = lambda y: min(max(picture.getpixel((x, y))) for x in range(text - 2, text + 2)) < 235
    frames, start = [], None
    for y in range(height):
        start = (y if start is None else start) if is_line(y) else None
        if start is not None and y - start == 3 * text:
            frames.append(y)
        elif start is not None and y - start > 3 * text:
            frames[-1] = y
    view = picture.crop((0, 0, width, frames[0] + text // 2))
    return view, picture.crop((0, frames[-1] + text // 2, width, height))


if __name__ == "__main__":
    main()
