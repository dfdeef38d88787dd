"""Cells of the meshes of other packages: which are triangles and quadrilaterals, and which keep their vertices."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gpu_smooth import _native
from gpu_smooth._ends import between_regions, boundary_of
from gpu_smooth._errors import MeshError, OptionError

if TYPE_CHECKING:
    import numpy.typing as npt

    from gpu_smooth._options import Integers, Surface

# Names of cell data that number the regions of elements, the first that a mesh has: of gmsh, Medit, Salome and VTK.
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
    """Region of each triangle, then of each quadrilateral, of shape (m + k,); None without regions."""
    quadrilaterals: Integers = np.empty((0, 4), np.int64)
    """Vertices of each quadrilateral, of shape (k, 4)."""
    ends: Integers = np.empty(0, np.int64)
    """Vertices at which groups of lines or vertices end, of shape (k,). They stay where others slide."""
    periodic: Integers = np.empty((0, 2), np.int64)
    """Pairs of vertices that slide together, of shape (k, 2)."""
    of_model: Integers = np.empty(0, np.int64)
    """Vertices inside the mesh on curves of a model that have no lines, of shape (k,). They stay unless lines are free."""
    surface: Surface | None = None
    """Meaning of the coordinates that the mesh states; None if the mesh states none."""
    interpolated: tuple[str, ...] = ()
    """Names of the data of vertices that are interpolated where vertices have moved."""

    def options(self, given: dict[str, Any], vertices: int) -> dict[str, Any]:
        """Return options with the constraints of the cells, beside those that were given."""
        if not len(self.triangles) and not len(self.quadrilaterals):
            raise MeshError(
                "mesh: there are no triangles of three vertices, and no quadrilaterals of four that move. Pass a mesh of linear "
                "elements"
            )
        # None is the default of each option.
        given = {name: value for name, value in given.items() if value is not None}
        unknown = self.anchored[(self.anchored < 0) | (self.anchored >= vertices)]
        if len(unknown):
            raise MeshError(
                f"mesh: a cell has the vertex {unknown[0]}, but the mesh has {vertices} points: vertices are numbered from 0"
            )
        fixed = np.zeros(vertices, dtype=bool)
        fixed[self.anchored] = True
        if not given.get("free_lines"):
            fixed[self.of_model] = True
        if given.get("slide"):
            fixed[self._ends_that_slide(vertices) if given.get("free_lines") else self.ends] = True
        if "fixed" in given:
            fixed[_native.vertex_set("fixed", given["fixed"], vertices)] = True
        lines = self.lines
        if "lines" in given:
            lines = np.concatenate([lines, _native.pairs("lines", given["lines"], vertices)])
        found: dict[str, Any] = {"fixed": fixed, "lines": lines}
        if self.regions is not None:
            found["regions"] = self.regions
        if given.get("slide") and len(self.periodic):
            found["periodic"] = self.periodic
        if len(self.quadrilaterals):
            found["quadrilaterals"] = self.quadrilaterals
        if self.surface is not None:
            found["surface"] = self.surface
        return {**found, **{name: value for name, value in given.items() if name not in ("fixed", "lines")}}

    def _ends_that_slide(self, vertices: int) -> Integers:
        """Return the ends of groups along which vertices slide if lines are free: on the boundary and between regions."""
        curves = self.boundary().ravel()
        if self.regions is not None:
            curves = np.union1d(curves, between_regions(self.regions, self.triangles, self.quadrilaterals, vertices))
        return np.intersect1d(self.ends, curves)

    def boundary(self) -> Integers:
        """Return the edges of exactly one triangle or quadrilateral, of shape (k, 2)."""
        return boundary_of(self.triangles, self.quadrilaterals)

    def proper(self) -> Cells:
        """Return the cells without quadrilaterals that list a vertex twice, whose vertices stay."""
        corners = np.sort(self.quadrilaterals, axis=1)
        is_proper = (corners[:, 1:] != corners[:, :-1]).all(axis=1)
        if is_proper.all():
            return self
        is_kept = np.concatenate([np.ones(len(self.triangles), bool), is_proper])
        return self._replace(
            quadrilaterals=self.quadrilaterals[is_proper],
            anchored=np.concatenate([self.anchored, self.quadrilaterals[~is_proper].ravel()]),
            regions=None if self.regions is None else self.regions[is_kept],
        )

    def choosing(self, word: Any) -> Cells:
        """Return the cells with quadrilaterals that move or stay, as the option `quadrilaterals` says."""
        if not isinstance(word, (str, type(None))) or word not in ("keep", "move", None):
            raise OptionError(
                f"quadrilaterals: the value is {word!r:.40}, and must be \"keep\" or \"move\" for a mesh, which has its own. Pass arrays to "
                "pass others"
            )
        if word == "keep":
            return self.kept()
        return self

    def kept(self) -> Cells:
        """Return the cells with triangles alone. The vertices of quadrilaterals stay."""
        return self._replace(
            quadrilaterals=self.quadrilaterals[:0],
            anchored=np.concatenate([self.anchored, self.quadrilaterals.ravel()]),
            regions=None if self.regions is None else self.regions[: len(self.triangles)],
        )


def of_faces(faces: Integers, surface: Surface | None = None) -> Cells:
    """Return the cells of a mesh of faces, each a row of vertices with -1 beyond the last; of shape (m, k)."""
    sizes = np.count_nonzero(faces >= 0, axis=1)
    triangles, quadrilaterals = (faces[sizes == size, :size].reshape(-1, size) for size in (3, 4))
    others = faces[(sizes != 3) & (sizes != 4)]
    lines = np.empty((0, 2), np.int64)
    return Cells(triangles, lines, others[others >= 0], None, quadrilaterals, surface=surface)


def with_groups(options: dict[str, Any], groups: Callable[[], dict[str, Callable[[], Any]]]) -> dict[str, Any]:
    """Return options with vertices in place of the groups that `fixed` and `keep_layers` name.

    `groups` returns a function for each name, which returns the vertices of the group.
    """
    found = dict(options)
    if "fixed" in options:
        found["fixed"] = named(options["fixed"], groups())
    layers = options.get("keep_layers")
    if isinstance(layers, str) and "," in layers:
        layers = tuple(layers.split(",", 1))
    if isinstance(layers, tuple) and len(layers) == 2:
        walls = layers[1]
        names = walls.split(",") if isinstance(walls, str) and walls not in groups() else walls
        found["keep_layers"] = (layers[0], named(names, groups(), "keep_layers"))
    return found


def named(fixed: Any, groups: dict[str, Callable[[], Any]], option: str = "fixed") -> Any:
    """Return the vertices of groups that `fixed` names: a name, or a list of names. Other values are returned as they are.

    `groups` has a function for each name, which returns the vertices of the group. `option` is the option that has the
    names.
    """
    names = [fixed] if isinstance(fixed, str) else fixed
    if isinstance(names, np.ndarray) and names.dtype.kind == "U":
        names = names.tolist()
    if not isinstance(names, (list, tuple, set)) or not names or not all(isinstance(name, str) for name in names):
        return fixed
    unknown = [name for name in names if name not in groups]
    if unknown:
        known = ", ".join(sorted(groups)) or "none"
        raise MeshError(f"{option}: the mesh has no group {unknown[0]!r}. Its groups are: {known}")
    return np.unique(np.concatenate([np.asarray(groups[name](), np.int64).ravel() for name in names]))


def whole(values: npt.NDArray[Any]) -> npt.NDArray[Any] | None:
    """Return numbers or names of regions as integers; None if they are numbers, but no whole numbers."""
    values = np.asarray(values)
    # One number per cell, as a column.
    if values.ndim == 2 and values.shape[1] == 1:
        values = values[:, 0]
    if values.ndim != 1:
        return None
    if values.dtype.kind == "i":
        return values
    if values.dtype.kind == "f" and not (np.isfinite(values) & (values == np.trunc(values))).all():
        return None
    # Other integers, flags, floating-point numbers of any size and names become integers that differ where they do.
    return np.unique(values, return_inverse=True)[1] if values.dtype.kind in "ubfUS" else None
