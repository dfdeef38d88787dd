"""Makes a mesh of a coast by OCSMesh, and makes the mesh orthogonal, as solvers with unknowns at circumcenters need it.

Run: python ocsmesh_coast.py coast.2dm; needs ocsmesh and gmsh. No data are downloaded: the elevation model is made here.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
import ocsmesh
import rasterio

import gpu_smooth


def elevation(path: Path) -> None:
    """Write the heights of a shelf of 60 km by 60 km above sea level, in meters, with a swinging shore and an island."""
    count, cell = 300, 200.0
    x, y = np.meshgrid(*[(np.arange(count) + 0.5) * cell] * 2)
    shore = 15e3 + 4e3 * np.sin(x / 6e3) + 2e3 * np.sin(x / 2.3e3 + 1)
    island = 8 - (x - 35e3) ** 2 / 1.1e6 - (y - 32e3) ** 2 / 0.5e6
    heights = np.maximum((shore - y) / 500, island).astype(np.float32)
    place = rasterio.transform.from_origin(500e3, 4500e3, cell, cell)
    shape = {"height": count, "width": count, "count": 1, "dtype": "float32"}
    with rasterio.open(path, "w", driver="GTiff", crs="EPSG:32618", transform=place, **shape) as file:
        file.write(heights[::-1], 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path, metavar="OUT", help="the 2dm file to write")
    out = parser.parse_args().out
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "heights.tif"
        elevation(path)
        sizes = ocsmesh.Hfun(ocsmesh.Raster(path), hmin=300, hmax=1000)
        sizes.add_contour(level=0, expansion_rate=0.05, target_size=300)
        driver = ocsmesh.MeshDriver(ocsmesh.Geom(ocsmesh.Raster(path), zmax=0), sizes, engine_name="gmsh", bnd_representation="adapt")
        mesh = driver.run()
        data = mesh.meshdata
        result = gpu_smooth.run(data.coords, data.tria, scheme="acute", slide=True)
        data.coords = result.points
        # Depths belong to places, so they are read at the new nodes.
        mesh.interpolate(ocsmesh.Raster(path))
    oblique, obtuse = [
        [int((gpu_smooth.quality(points, data.tria, measure) > limit).sum()) for points in (result.points_before, result.points)]
        for measure, limit in (("orthogonality", 0.02), ("max-angle", 90.0))
    ]
    print(f"{len(data.tria)} triangles, oblique edges at {oblique[0]} -> {oblique[1]}, obtuse {obtuse[0]} -> {obtuse[1]}")
    mesh.write(str(out), format="2dm", overwrite=True)


if __name__ == "__main__":
    main()
