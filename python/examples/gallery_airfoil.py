"""Smooths the mesh of an airfoil: its boundary layer keeps the stretching and the orientation of its triangles.

Run: python gallery_airfoil.py [airfoil.png]; needs gmsh and matplotlib.
"""

from __future__ import annotations

import argparse

import gmsh
import numpy as np

import gpu_smooth


def mesh() -> None:
    """Mesh the air around a NACA 0012 profile by gmsh, with a boundary layer of triangles."""
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, 60)))
    half = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    add = gmsh.model.geo
    upper = [add.addPoint(a, b, 0, 0.02) for a, b in zip(x, half)]
    lower = [add.addPoint(a, -b, 0, 0.02) for a, b in zip(x[1:-1], half[1:-1])]
    profile = [add.addSpline(upper), add.addSpline([upper[-1], *lower[::-1], upper[0]])]
    far = [add.addPoint(a, b, 0, 0.3) for a, b in ((-1, -1.2), (2.5, -1.2), (2.5, 1.2), (-1, 1.2))]
    outer = [add.addLine(a, b) for a, b in zip(far, [*far[1:], far[0]])]
    add.addPlaneSurface([add.addCurveLoop(outer), add.addCurveLoop(profile)])
    add.synchronize()
    field = gmsh.model.mesh.field.add("BoundaryLayer")
    gmsh.model.mesh.field.setNumbers(field, "CurvesList", profile)
    gmsh.model.mesh.field.setNumbers(field, "FanPointsList", [upper[-1]])
    for name, value in (("Size", 0.004), ("Ratio", 1.3), ("Thickness", 0.05), ("Quads", 0)):
        gmsh.model.mesh.field.setNumber(field, name, value)
    gmsh.model.mesh.field.setAsBoundaryLayer(field)
    gmsh.option.setNumber("Mesh.Smoothing", 0)
    gmsh.model.mesh.generate(2)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("picture", nargs="?", help="file for the picture; without it, nothing is drawn")
    picture = parser.parse_args().picture
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    mesh()
    result = gpu_smooth.smooth_gmsh_model(target="keep-shape")
    print(result)
    if picture:
        figure = result.plot(measure="imr", picture_range=(1, 4))
        for axes in figure.axes[:2]:
            axes.set(xlim=(-0.1, 0.4), ylim=(-0.13, 0.15))
        figure.savefig(picture, dpi=110)
    gmsh.finalize()


if __name__ == "__main__":
    main()
