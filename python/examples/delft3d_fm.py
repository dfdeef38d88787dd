"""Makes a grid for Delft3D FM orthogonal, as in a script with dfm_tools: MeshKernel makes, gpu-smooth smooths, xugrid writes.

Run: python delft3d_fm.py grid_net.nc
"""

from __future__ import annotations

import argparse
from pathlib import Path

import meshkernel
import numpy as np
import xugrid

import gpu_smooth


def lake() -> meshkernel.MeshKernel:
    """Return a MeshKernel with triangles in a lake whose shore swings."""
    turn = np.linspace(0, 2 * np.pi, 121)
    radius = 1000 + 120 * np.cos(3 * turn) + 60 * np.sin(7 * turn)
    x, y = 1.5 * radius * np.cos(turn), radius * np.sin(turn)
    # The last point of a polygon is the first again, without rounding.
    x[-1], y[-1] = x[0], y[0]
    shore = meshkernel.GeometryList(x, y)
    kernel = meshkernel.MeshKernel()
    kernel.mesh2d_make_triangular_mesh_from_polygon(shore)
    return kernel


def refused_edges(kernel: meshkernel.MeshKernel) -> int:
    """Count the edges with which D-Flow FM does not start, and those that it closes to the flow."""
    values = np.asarray(kernel.mesh2d_get_orthogonality().values)
    links = kernel.mesh2d_get_small_flow_edge_centers(0.1)
    return int((values > 0.5).sum()) + len(links.x_coordinates)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, metavar="OUT", help="the netCDF file to write")
    out = parser.parse_args().out
    kernel = lake()
    before = refused_edges(kernel)
    smoothed = gpu_smooth.smooth(kernel.mesh2d_get(), scheme="acute")
    kernel.mesh2d_set(smoothed)
    print(f"{len(smoothed.face_x)} triangles, refused edges {before} -> {refused_edges(kernel)}")
    # dfm_tools has the same step as `meshkernel_to_UgridDataset`.
    xugrid.Ugrid2d.from_meshkernel(smoothed).to_dataset().to_netcdf(out)


if __name__ == "__main__":
    main()
