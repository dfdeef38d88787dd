"""Cells of the meshes of other packages: which are triangles, and which keep their vertices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gpu_smooth._errors import MeshError

if TYPE_CHECKING:
    import numpy.typing as npt

    from gpu_smooth._options import Integers

# Names of cell data that number the regions of triangles, the first that a mesh has: of gmsh, Medit, Salome and VTK.
REGIONS = ("gmsh:physical", "medit:ref", "gmsh:geometrical", "cell_tags", "region", "material", "MaterialIds")


class Cells(NamedTuple):
    """Cells of a mesh, as arguments of `smooth`."""

    triangles: Integers
    """Vertices of each triangle, of shape (m, 3)."""
    lines: Integers
    """Edges of line elements, of shape (k, 2)."""
    anchored: Integers
    """Vertices of all other cells, of shape (k,)."""
    regions: npt.NDArray[Any] | None
    """Region of each triangle, of shape (m,); None without regions."""

    def options(self, given: dict[str, Any], vertices: int) -> dict[str, Any]:
        """Return options with the constraints of the cells, beside those that were given."""
        if not len(self.triangles):
            raise MeshError("mesh: there are no triangles with three vertices. Pass a mesh of linear triangles")
        # None is the default of each option.
        given = {name: value for name, value in given.items() if value is not None}
        fixed = np.zeros(vertices, dtype=bool)
        fixed[self.anchored] = True
        if "fixed" in given:
            own = np.asarray(given["fixed"])
            # Wrong arrays are passed on, so that the error is that of `smooth`.
            if own.dtype == bool and own.shape == fixed.shape:
                fixed |= own
            elif own.dtype.kind in "iu" and own.ndim == 1 and ((own >= 0) & (own < vertices)).all():
                fixed[own] = True
            else:
                return given
        lines = self.lines
        if "lines" in given:
            drawn = np.asarray(given["lines"])
            if drawn.ndim != 2 or drawn.shape[1] != 2:
                return given
            lines = np.concatenate([lines, drawn])
        found = {"fixed": fixed, "lines": lines}
        if self.regions is not None:
            found["regions"] = self.regions
        return {**found, **{name: value for name, value in given.items() if name not in ("fixed", "lines")}}


def whole(values: npt.NDArray[Any]) -> npt.NDArray[Any] | None:
    """Return numbers of regions as integers; None if they are no whole numbers."""
    values = np.asarray(values)
    if values.ndim != 1:
        return None
    if values.dtype.kind in "iu":
        return values
    integers = values.astype(np.int64) if values.dtype.kind == "f" and np.isfinite(values).all() else None
    return integers if integers is not None and (integers == values).all() else None
