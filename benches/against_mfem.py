#!/usr/bin/env python3
"""Minimizes the same objective on the same mesh by gpu-smooth and by MFEM's TMOP, and compares the minima and the times.

    pip install mfem numpy                      # tried with 4.10: its wheel contains the C++ library, which does the work
    python3 benches/against_mfem.py target/release/gpu-smooth [CELLS] [quadrilaterals]

The mesh is a square of CELLS x CELLS cells. Cells are halved along random diagonals, and vertices are moved by up to 0.3 cells
along each axis. Quadrilaterals are not halved, their vertices are moved by up to 0.2 cells, and the sides of the square are bent,
so that no lattice of squares is the minimum. The target is the equilateral triangle of the mean area, or the square
(IDEAL_SHAPE_EQUAL_SIZE), and the boundary is fixed. A linear triangle has a constant T, so a quadrature of one point is exact.
Quadrilaterals have the Gauss-Lobatto points of order 1, which are their corners. MFEM takes Newton steps with MINRES, as its
mesh-optimizer does. MFEM and gpu-smooth each use one thread of the CPU.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

import numpy as np
import mfem.ser as mfem
from mfem._ser import tmop, tmop_tools


def lattice(cells, by, rng):
    side = cells + 1
    x, y = np.meshgrid(np.arange(side, dtype=float), np.arange(side, dtype=float))
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    inner = ((points > 0) & (points < cells)).all(axis=1)
    points[inner] += rng.uniform(-by, by, (inner.sum(), 2))
    return points


def quadrilaterals(cells, seed=1):
    points, side = lattice(cells, 0.2, np.random.default_rng(seed)), cells + 1
    x, y = (points / cells).T
    bent = np.stack([x + 0.1 * np.sin(np.pi * y), y + 0.15 * np.sin(2 * np.pi * x) * (1 - 0.5 * y)], axis=1)
    corner = (np.arange(cells) + side * np.arange(cells)[:, None]).ravel()
    return bent, np.stack([corner, corner + 1, corner + side + 1, corner + side], axis=1)


def made(cells, seed=1):
    rng = np.random.default_rng(seed)
    points, side = lattice(cells, 0.3, rng), cells + 1
    triangles = []
    for j in range(cells):
        for i in range(cells):
            a, b = j * side + i, j * side + i + 1
            d, c = a + side, b + side
            if rng.integers(2):
                triangles += [(a, b, c), (a, c, d)]
            else:
                triangles += [(a, b, d), (b, c, d)]
    return points / cells, np.array(triangles)


def write(folder, points, elements, cells):
    side = cells + 1
    rows = [f"{x!r} {y!r}" for x, y in points.tolist()]
    with open(f"{folder}/in.mesh", "w") as out:
        print(f"MeshVersionFormatted 2\nDimension 2\nVertices\n{len(rows)}", file=out)
        print(*(row + " 0" for row in rows), sep="\n", file=out)
        kind = "Triangles" if elements.shape[1] == 3 else "Quadrilaterals"
        print(f"{kind}\n{len(elements)}", file=out)
        print(*(" ".join(map(str, element + 1)) + " 1" for element in elements), sep="\n", file=out)
        print("End", file=out)
    line = np.arange(cells)
    edges = [(line, line + 1), (line + cells * side, line + 1 + cells * side)]
    edges += [(line * side, (line + 1) * side), (line * side + cells, (line + 1) * side + cells)]
    with open(f"{folder}/mfem.mesh", "w") as out:
        print("MFEM mesh v1.0\n\ndimension\n2\n\nelements", len(elements), sep="\n", file=out)
        geometry = {3: 2, 4: 3}[elements.shape[1]]
        print(*(f"1 {geometry} " + " ".join(map(str, element)) for element in elements), sep="\n", file=out)
        print("\nboundary", 4 * cells, sep="\n", file=out)
        for a, b in edges:
            print(*(f"1 1 {p} {q}" for p, q in zip(a, b)), sep="\n", file=out)
        print("\nvertices", len(rows), 2, sep="\n", file=out)
        print(*rows, sep="\n", file=out)


def by_mfem(folder, metric, elements, tolerance):
    mesh = mfem.Mesh(f"{folder}/mfem.mesh", 1, 1)
    space = mfem.FiniteElementSpace(mesh, mfem.H1_FECollection(1, 2), 2)
    mesh.SetNodalFESpace(space)
    x = mfem.GridFunction(space)
    mesh.SetNodalGridFunction(x)
    count = len(elements)
    of_triangles = elements.shape[1] == 3
    area = sum(mesh.GetElementVolume(e) for e in range(count)) / count
    target = tmop.TargetConstructor(tmop.TargetConstructor.IDEAL_SHAPE_EQUAL_SIZE)
    target.SetNodes(x)
    # MFEM takes the mean area as the determinant of W, which is twice the area of a triangle.
    if of_triangles:
        target.SetVolumeScale(2.0)
    integrator = tmop.TMOP_Integrator(metric, target)
    rules = mfem.IntegrationRules(0, mfem.Quadrature1D.GaussLobatto)
    integrator.SetIntegrationRules(rules, 1)
    form = mfem.NonlinearForm(space)
    form.AddDomainIntegrator(integrator)
    boundary = mfem.intArray([1] * mesh.bdr_attributes.Max())
    form.SetEssentialBC(boundary)
    energy = lambda: form.GetGridFunctionEnergy(x) / area / count
    start = energy()
    linear = mfem.MINRESSolver()
    linear.SetMaxIter(100)
    linear.SetRelTol(1e-12)
    linear.SetAbsTol(0.0)
    geometry = mfem.Geometry.TRIANGLE if of_triangles else mfem.Geometry.SQUARE
    solver = tmop_tools.TMOPNewtonSolver(rules.Get(geometry, 1))
    solver.SetIntegrationRules(rules, 1)
    solver.SetOperator(form)
    solver.SetPreconditioner(linear)
    solver.SetMaxIter(200)
    solver.SetRelTol(tolerance)
    solver.SetAbsTol(0.0)
    solver.SetPrintLevel(-1)
    x.SetTrueVector()
    began = time.perf_counter()
    solver.Mult(mfem.Vector(), x.GetTrueVector())
    took = time.perf_counter() - began
    x.SetFromTrueVector()
    return start, energy(), solver.GetNumIterations(), took


def by_gpu_smooth(program, folder, name):
    command = [program, f"{folder}/in.mesh", f"{folder}/out.mesh", "--engine", "cpu", "--scheme", name]
    command += ["--tolerance", "1e-9", "--report", f"{folder}/report.json", "-q"]
    subprocess.run(command, check=True, env={**os.environ, "RAYON_NUM_THREADS": "1"})
    return json.load(open(f"{folder}/report.json"))


def main():
    program, cells = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 100
    of_triangles = "quadrilaterals" not in sys.argv
    points, elements = (made if of_triangles else quadrilaterals)(cells)
    metrics = [("tmop-2", tmop.TMOP_Metric_002()), ("shape-size", tmop.TMOP_Metric_007())]
    metrics += [("tmop-94", tmop.TMOP_Metric_094()), ("tmop-80", tmop.TMOP_Metric_080(0.5))]
    with tempfile.TemporaryDirectory() as folder:
        write(folder, points, elements, cells)
        print(f"{len(points)} vertices, {len(elements)} {'triangles' if of_triangles else 'quadrilaterals'}")
        for name, metric in metrics:
            report = by_gpu_smooth(program, folder, name)
            took = report["seconds"]["prepare"] + report["seconds"]["smooth"]
            start, end = report["before"]["f"][name], report["after"]["f"][name]
            print(f"{name}: f {start:.10f} at the start")
            print(f"  gpu-smooth: {end:.10f}, {report['sweeps']} sweeps, {took:.3f} s")
            for tolerance in (1e-3, 1e-8):
                other, lower, steps, seconds = by_mfem(folder, metric, elements, tolerance)
                assert abs(other / start - 1) < 1e-9, f"f is {other} there"
                print(f"  MFEM to {tolerance:g} of the gradient: {lower:.10f}, {steps} steps, {seconds:.2f} s; ", end="")
                print(f"f of gpu-smooth {end / lower - 1:+.1e} against it, time {seconds / took:.0f} : 1")


main()
