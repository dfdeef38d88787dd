"""Smooths a part of two materials: vertices between the materials slide along the interface, and none leaves it.

Run: python gallery_two_materials.py [part.png]; needs gmsh and matplotlib.
"""

from __future__ import annotations

import argparse

import gmsh
import numpy as np
import numpy.typing as npt

import gpu_smooth


def mesh() -> None:
    """Mesh a plate with three inclusions by gmsh."""
    add = gmsh.model.occ
    plate = add.addRectangle(0, 0, 0, 6, 4)
    inclusions = [
        (2, add.addDisk(1.5, 1.3, 0, 0.9, 0.7)), (2, add.addDisk(4.3, 1.4, 0, 0.8, 0.8)),
        (2, add.addDisk(3.0, 3.0, 0, 1.3, 0.5)),
    ]
    add.fragment([(2, plate)], inclusions)
    add.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.22)
    gmsh.option.setNumber("Mesh.Smoothing", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 5)
    gmsh.model.mesh.generate(2)


def rows_of(tags: npt.NDArray[np.uint64]) -> npt.NDArray[np.int64]:
    """Return the rows of nodes in the points of a result."""
    all_tags = gmsh.model.mesh.getNodes()[0]
    order = np.argsort(all_tags)
    rows: npt.NDArray[np.int64] = order[np.searchsorted(all_tags, tags, sorter=order)]
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("picture", nargs="?", help="file for the picture; without it, nothing is drawn")
    picture = parser.parse_args().picture
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    mesh()
    result = gpu_smooth.smooth_gmsh_model(slide=True)
    print(f"{result}, {result.slid} vertices have slid")
    if picture:
        figure = result.plot(measure="imr", picture_range=(1, 1.6))
        for _, curve in gmsh.model.getEntities(1):
            lines = gmsh.model.mesh.getElements(1, curve)[2]
            if not len(lines):
                continue
            for axes in figure.axes[:2]:
                points = result.points_before if axes.get_title() == "before" else result.points
                ends = points[rows_of(lines[0])].reshape(-1, 2, 3)
                axes.plot(ends[:, :, 0].T, ends[:, :, 1].T, color="black", linewidth=1)
        figure.savefig(picture, dpi=110)
    gmsh.finalize()


if __name__ == "__main__":
    main()
