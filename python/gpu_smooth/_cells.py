"""Cells of the meshes of other packages: which are triangles, and which keep their vertices."""

from __future__ import annotations

from collections.abc import Callable
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


def named(fixed: Any, groups: dict[str, Callable[[], Any]]) -> Any:
    """Return the vertices of groups that `fixed` names: a name, or a list of names. Other values are returned as they are.

    `groups` has a function for each name, which returns the vertices of the group.
    """
    names = [fixed] if isinstance(fixed, str) else fixed
    if not isinstance(names, (list, tuple, set)) or not names or not all(isinstance(name, str) for name in names):
        return fixed
    unknown = [name for name in names if name not in groups]
    if unknown:
        known = ", ".join(sorted(groups)) or "none"
        raise MeshError(f"fixed: the mesh has no group {unknown[0]!r}. Its groups are: {known}")
    return np.unique(np.concatenate([np.asarray(groups[name](), np.int64).ravel() for name in names]))


def whole(values: npt.NDArray[Any]) -> npt.NDArray[Any] | None:
    """Return numbers of regions as integers; None if they are no whole numbers."""
    values = np.asarray(values)
    if values.ndim != 1:
        return None
    if values.dtype.kind in "iu":
        return values
    integers = values.astype(np.int64) if values.dtype.kind == "f" and np.isfinite(values).all() else None
    return integers if integers is not None and (integers == values).all() else None
