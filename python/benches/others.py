"""Compares smoothers of Python on the same arrays: quality and time of each. Prints the tables of docs/python.md.

Run: python others.py [MESH...]; needs mmgpy, gmsh, pyvista, scipy and mfem. Build gpu-smooth with optimization: pip install ./python
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gmsh
import mmgpy
import numpy as np
import pyvista
from overhead import lattice
from scipy.optimize import minimize

import gpu_smooth

MESHES = Path(__file__).parents[2] / "meshes"
Result = tuple[Any, Any]


def of_gpu_smooth(points: Any, triangles: Any) -> Result:
    return gpu_smooth.smooth(points, triangles, engine="cpu"), triangles


def of_mmg(points: Any, triangles: Any) -> Result:
    """Optimize without insertion. mmg swaps edges too."""
    mesh = mmgpy.MmgMesh2D(points, triangles.astype(np.int32))
    mesh.remesh(noinsert=True, optim=True, verbose=-1)
    return mesh.get_vertices(), mesh.get_triangles()


def of_gmsh(method: str) -> Callable[[Any, Any], Result]:
    def optimize(points: Any, triangles: Any) -> Result:
        gmsh.initialize(interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
        surface = gmsh.model.addDiscreteEntity(2)
        tags = np.arange(1, len(points) + 1)
        in_space = np.column_stack([points, np.zeros(len(points))])
        gmsh.model.mesh.addNodes(2, surface, tags, in_space.ravel())
        gmsh.model.mesh.addElementsByType(surface, 2, [], (triangles + 1).ravel())
        # Without a geometry, gmsh's optimizers invert triangles.
        gmsh.model.mesh.createGeometry()
        gmsh.model.mesh.optimize(method, niter=10)
        found, coordinates, _ = gmsh.model.mesh.getNodes()
        moved = np.empty_like(in_space)
        moved[np.asarray(found, int) - 1] = np.reshape(coordinates, (-1, 3))
        gmsh.finalize()
        return moved[:, :2], triangles

    return optimize


def of_pyvista(points: Any, triangles: Any) -> Result:
    """Smooth by averaging, as vtkSmoothPolyDataFilter does."""
    in_space = np.column_stack([points, np.zeros(len(points))])
    surface = pyvista.PolyData.from_regular_faces(in_space, triangles)
    smoothed = surface.smooth(n_iter=100, relaxation_factor=0.2, boundary_smoothing=False)
    return np.asarray(smoothed.points)[:, :2].astype(float), triangles


def of_scipy(points: Any, triangles: Any) -> Result:
    """Minimize the objective of gpu-smooth, the mean of imr², by L-BFGS."""
    free = gpu_smooth.Smoother(points, triangles).free

    def objective(unknowns: Any) -> tuple[float, Any]:
        at = points.copy()
        at[free] = unknowns.reshape(-1, 2)
        a, b, c = (at[triangles[:, k]] for k in range(3))
        u, v = b - a, c - a
        area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        if (area <= 0).any():
            return 1e10, np.zeros_like(unknowns)
        squares = (u**2 + v**2 + (v - u) ** 2).sum(axis=1)
        q = squares / (2 * np.sqrt(3) * area)
        # Derivatives of q² by the three corners.
        scale = (2 * q / len(triangles))[:, None]
        of_square = [2 * (2 * x - y - z) for x, y, z in ((a, b, c), (b, c, a), (c, a, b))]
        turned = [np.stack([y[:, 1] - z[:, 1], z[:, 0] - y[:, 0]], axis=1) for y, z in ((b, c), (c, a), (a, b))]
        gradient = np.zeros_like(at)
        for k in range(3):
            slope = scale * q[:, None] * (of_square[k] / squares[:, None] - turned[k] / area[:, None])
            for axis in range(2):
                gradient[:, axis] += np.bincount(triangles[:, k], slope[:, axis], len(at))
        # The logarithm has the same minimum, and lets L-BFGS begin at a mesh with very flat triangles.
        f = float((q**2).mean())
        return np.log(f), gradient[free].ravel() / f

    options = {"maxiter": 5000, "maxfun": 10000, "ftol": 1e-12, "gtol": 1e-9, "maxcor": 20}
    found = minimize(objective, points[free].ravel(), jac=True, method="L-BFGS-B", options=options)
    smoothed = points.copy()
    smoothed[free] = found.x.reshape(-1, 2)
    return smoothed, triangles


def of_mfem(points: Any, triangles: Any) -> Result:
    """Minimize the mean of imr - 1, MFEM's TMOP metric 2, by Newton steps with MINRES, as MFEM's mesh-optimizer does."""
    import mfem.ser as mfem
    from mfem._ser import tmop, tmop_tools

    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges, counts = np.unique(edges, axis=0, return_counts=True)
    boundary = edges[counts == 1]
    with tempfile.NamedTemporaryFile("w", suffix=".mesh") as file:
        print("MFEM mesh v1.0\n\ndimension\n2\n\nelements", len(triangles), sep="\n", file=file)
        np.savetxt(file, np.column_stack([np.full((len(triangles), 2), (1, 2)), triangles]), "%d")
        print("\nboundary", len(boundary), sep="\n", file=file)
        np.savetxt(file, np.column_stack([np.ones((len(boundary), 2), int), boundary]), "%d")
        print("\nvertices", len(points), 2, sep="\n", file=file)
        np.savetxt(file, points, "%.17g")
        file.flush()
        mesh = mfem.Mesh(file.name, 1, 0, False)
    space = mfem.FiniteElementSpace(mesh, mfem.H1_FECollection(1, 2), 2)
    mesh.SetNodalFESpace(space)
    x = mfem.GridFunction(space)
    mesh.SetNodalGridFunction(x)
    target = tmop.TargetConstructor(tmop.TargetConstructor.IDEAL_SHAPE_UNIT_SIZE)
    target.SetNodes(x)
    # MFEM keeps pointers: each object stays in a variable until the end.
    metric = tmop.TMOP_Metric_002()
    integrator = tmop.TMOP_Integrator(metric, target)
    rules = mfem.IntegrationRules(0, mfem.Quadrature1D.GaussLobatto)
    integrator.SetIntegrationRules(rules, 1)
    form = mfem.NonlinearForm(space)
    form.AddDomainIntegrator(integrator)
    held = mfem.intArray([1] * mesh.bdr_attributes.Max())
    form.SetEssentialBC(held)
    linear = mfem.MINRESSolver()
    linear.SetMaxIter(100)
    linear.SetRelTol(1e-12)
    solver = tmop_tools.TMOPNewtonSolver(rules.Get(mfem.Geometry.TRIANGLE, 1))
    solver.SetIntegrationRules(rules, 1)
    solver.SetOperator(form)
    solver.SetPreconditioner(linear)
    solver.SetOperator(form)
    solver.SetPreconditioner(linear)
    solver.SetMaxIter(200)
    solver.SetRelTol(1e-5)
    solver.SetPrintLevel(-1)
    x.SetTrueVector()
    solver.Mult(mfem.Vector(), x.GetTrueVector())
    x.SetFromTrueVector()
    moved = np.array(x.GetDataArray())
    return moved.reshape(2, -1).T, triangles


SMOOTHERS: dict[str, Callable[[Any, Any], Result]] = {
    "gpu-smooth, CPU": of_gpu_smooth,
    "SciPy, L-BFGS on the same f": of_scipy,
    "MFEM, TMOP metric 2": of_mfem,
    "mmgpy, `noinsert`, swaps edges": of_mmg,
    "gmsh, `Laplace2D`": of_gmsh("Laplace2D"),
    "gmsh, `Relocate2D`": of_gmsh("Relocate2D"),
    "PyVista, `smooth`": of_pyvista,
}


def row(name: str, points: Any, triangles: Any, seconds: float | None) -> str:
    imr = gpu_smooth.quality(points, triangles, "imr")
    inverted = int((gpu_smooth.quality(points, triangles, "scaled-jacobian") <= 0).sum())
    f = f"{(imr**2).mean():.4f}" if np.isfinite(imr).all() else "∞"
    angle = gpu_smooth.quality(points, triangles, "min-angle").min()
    taken = "" if seconds is None else f"{1e3 * seconds:,.1f} ms"
    return f"| {name} | {f} | {imr.max():.3f} | {angle:.1f}° | {inverted} | {taken} |"


def table(title: str, points: Any, triangles: Any) -> None:
    print(f"\n| {title} | f | worst imr | least angle | inverted | time |\n|---|---|---|---|---|---|")
    print(row("before", points, triangles, None))
    for name, smoother in SMOOTHERS.items():
        best, result = np.inf, (points, triangles)
        for _ in range(3):
            start = time.perf_counter()
            result = smoother(points, triangles)
            best = min(best, time.perf_counter() - start)
            if best > 5.0:
                break
        print(row(name, *result, best), flush=True)


def main() -> None:
    for name in sys.argv[1:]:
        mesh = gpu_smooth.MeshFile(name)
        table(f"{Path(name).stem}, {len(mesh.points):,} vertices", mesh.points, mesh.triangles)
    if sys.argv[1:]:
        return
    plate = gpu_smooth.MeshFile(MESHES / "plate.node")
    table("plate with two holes, 2,001 vertices", plate.points, plate.triangles)
    table("lattice, 40,000 vertices", *lattice(199))


if __name__ == "__main__":
    main()
