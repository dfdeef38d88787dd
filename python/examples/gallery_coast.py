"""Smooths a coast: triangles become equilateral and keep the sizes of the mesh, which is fine along the shore.

Run: python gallery_coast.py [coast.png]; needs gmsh and matplotlib.
"""

from __future__ import annotations

import argparse

import gmsh
import numpy as np

import gpu_smooth


def mesh() -> None:
    """Mesh a bay with an island by gmsh, with sizes that grow away from the shore."""
    along = np.linspace(0, 10, 80)
    shore = 1.0 + 0.5 * np.sin(1.3 * along) + 0.25 * np.sin(4.1 * along) + 0.1 * np.sin(9.7 * along)
    add = gmsh.model.geo
    coast = [add.addPoint(x, y, 0) for x, y in zip(along, shore)]
    sea = [add.addPoint(10, 9, 0), add.addPoint(0, 9, 0)]
    corners = [*coast, *sea, coast[0]]
    outer = [add.addLine(a, b) for a, b in zip(corners, corners[1:])]
    turns = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    radius = 0.7 + 0.15 * np.sin(3 * turns) + 0.07 * np.cos(7 * turns)
    island = [
        add.addPoint(6 + r * np.cos(t), 4 + 0.7 * r * np.sin(t), 0) for r, t in zip(radius, turns)
    ]
    inner = [add.addLine(a, b) for a, b in zip(island, [*island[1:], island[0]])]
    add.addPlaneSurface([add.addCurveLoop(outer), add.addCurveLoop(inner)])
    add.synchronize()
    fields = gmsh.model.mesh.field
    fields.add("Distance", 1)
    fields.setNumbers(1, "CurvesList", [*outer[: len(coast) - 1], *inner])
    fields.add("Threshold", 2)
    for name, value in (("InField", 1), ("SizeMin", 0.1), ("SizeMax", 0.8), ("DistMin", 0), ("DistMax", 5)):
        fields.setNumber(2, name, value)
    fields.setAsBackgroundMesh(2)
    gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
    gmsh.option.setNumber("Mesh.Smoothing", 0)
    gmsh.model.mesh.generate(2)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("picture", nargs="?", help="file for the picture; without it, nothing is drawn")
    picture = parser.parse_args().picture
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    mesh()
    result = gpu_smooth.smooth_gmsh_model(target="keep-size")
    print(result)
    if picture:
        result.plot(measure="min-angle", picture_range=(20, 60)).savefig(picture, dpi=110)
    gmsh.finalize()


if __name__ == "__main__":
    main()
