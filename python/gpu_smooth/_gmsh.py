"""The mesh of the running gmsh session."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from gpu_smooth._cells import Cells, with_groups
from gpu_smooth._errors import GpuSmoothError, MeshError
from gpu_smooth._smooth import run

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from gpu_smooth._options import Integers, SmoothOptions
    from gpu_smooth._result import Result

# gmsh's types of elements.
LINE, TRIANGLE, QUADRILATERAL = 1, 2, 3


def smooth_gmsh_model(**options: Unpack[SmoothOptions]) -> Result:
    """Smooth the mesh of the running gmsh session in place.

    Nodes on points and curves of the model stay, also on those embedded in a surface. With `slide=True`, nodes on curves
    slide along them, and the nodes of periodic curves slide in pairs. Nodes of elements other than
    triangles and quadrilaterals stay. The
    parameters of moved nodes on their curves and surfaces are set too.

    Parameters
    ----------
    **options
        The options of `smooth`. Vertices are numbered by the rows of `gmsh.model.mesh.getNodes()`. `fixed` may also be the
        name of a physical group, or a list of names, and `keep_layers` may name groups of walls: `"rows=3,wall"`.

    Returns
    -------
    Result
        New points of all nodes, of shape (n, 3), in the order of `gmsh.model.mesh.getNodes()`, and a report.

    Raises
    ------
    GpuSmoothError
        No gmsh session is running.
    MeshError
        The mesh has no triangles of three nodes and no quadrilaterals of four, has volume elements, or does not lie in a plane.
    OptionError, DeviceError
        As `smooth` does.
    ImportError
        gmsh is not installed.
    """
    try:
        import gmsh
    except ModuleNotFoundError as missing:
        text = "the mesh of a gmsh session is needed, but gmsh is not installed: pip install gmsh"
        raise ModuleNotFoundError(text, name=missing.name) from missing

    if not gmsh.isInitialized():
        raise GpuSmoothError("no gmsh session is running: call gmsh.initialize() and mesh a model first")
    if not len(gmsh.model.mesh.getElementTypes(2)):
        raise MeshError(
            "mesh: the current model of the gmsh session has no elements on surfaces. Mesh the model first: "
            "gmsh.model.mesh.generate(2)"
        )
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    tags = np.asarray(tags, dtype=np.int64)
    points = np.asarray(coordinates, dtype=float).reshape(-1, 3)
    rows = np.full(int(tags.max(initial=0)) + 1, -1)
    rows[tags] = np.arange(len(tags))
    given = with_groups(dict(options), lambda: _groups(gmsh, rows))
    cells = _cells(gmsh, rows).proper().choosing(given.pop("quadrilaterals", None))
    given = cells.options(given, len(points))
    if np.ptp(points[np.union1d(cells.triangles, cells.quadrilaterals), 2]) == 0.0:
        # Nodes that no element has, such as centers of arcs, may have another z.
        given["z"] = "data"
    if given.get("slide") and given.get("periodic") is None:
        given["periodic"] = _periodic(gmsh, rows)
    result = run(points, cells.triangles, **given)
    moved = np.flatnonzero((result.points != points).any(axis=1))
    _set_nodes(gmsh, tags, rows, result.points, moved)
    return result


def _cells(gmsh: Any, rows: Integers) -> Cells:
    """Return the cells of the model. `rows` are the rows of nodes by their tags."""
    if len(gmsh.model.mesh.getElementTypes(3)):
        raise MeshError("mesh: there are volume elements, whose nodes must not move. Mesh the surfaces alone")
    triangles, quadrilaterals = [np.empty((0, 3), np.int64)], [np.empty((0, 4), np.int64)]
    of_triangles, of_others = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    lines, anchored = [np.empty((0, 2), np.int64)], [np.empty(0, np.int64)]
    for dimension, entity in gmsh.model.getEntities():
        # Nodes on points, and nodes on curves that no line has.
        if dimension < 2:
            nodes = rows[np.asarray(gmsh.model.mesh.getNodes(dimension, entity)[0], np.int64)]
            on_lines = np.empty(0, np.int64)
            types, _, of_types = gmsh.model.mesh.getElements(dimension, entity)
            for kind, connectivity in zip(types, of_types):
                corners = rows[np.asarray(connectivity, np.int64)]
                if kind == LINE:
                    lines.append(corners.reshape(-1, 2))
                    on_lines = np.union1d(on_lines, corners)
                else:
                    anchored.append(corners)
            anchored.append(np.setdiff1d(nodes, on_lines))
            continue
        types, _, of_types = gmsh.model.mesh.getElements(dimension, entity)
        for kind, connectivity in zip(types, of_types):
            corners = rows[np.asarray(connectivity, np.int64)]
            if kind == TRIANGLE:
                triangles.append(corners.reshape(-1, 3))
                of_triangles.append(np.full(len(corners) // 3, entity))
            elif kind == QUADRILATERAL:
                quadrilaterals.append(corners.reshape(-1, 4))
                of_others.append(np.full(len(corners) // 4, entity))
            else:
                anchored.append(corners)
    return Cells(
        np.concatenate(triangles), np.concatenate(lines), np.concatenate(anchored),
        np.concatenate([*of_triangles, *of_others]), np.concatenate(quadrilaterals),
    )


def _groups(gmsh: Any, rows: Integers) -> dict[str, Callable[[], Any]]:
    """Return the named physical groups of the model."""

    def nodes(pairs: list[tuple[int, int]]) -> Any:
        tags = [gmsh.model.mesh.getNodesForPhysicalGroup(*pair)[0] for pair in pairs]
        return rows[np.concatenate(tags).astype(np.int64)]

    # Groups of several dimensions may have one name.
    groups: dict[str, list[tuple[int, int]]] = {}
    for pair in gmsh.model.getPhysicalGroups():
        groups.setdefault(gmsh.model.getPhysicalName(*pair), []).append(pair)
    return {name: functools.partial(nodes, pairs) for name, pairs in groups.items() if name}


def _periodic(gmsh: Any, rows: Integers) -> Integers:
    """Return the pairs of nodes of periodic curves, of shape (k, 2)."""
    pairs = [np.empty((0, 2), np.int64)]
    for _, curve in gmsh.model.getEntities(1):
        master, nodes, of_master, _ = gmsh.model.mesh.getPeriodicNodes(1, curve)
        if master != curve and len(nodes):
            pairs.append(rows[np.stack([of_master, nodes], axis=1).astype(np.int64)])
    return np.concatenate(pairs)


def _set_nodes(gmsh: Any, tags: Integers, rows: Integers, points: Any, moved: Integers) -> None:
    """Set the places of moved nodes, and their parameters on the curve or surface to which they belong."""
    is_moved = np.zeros(len(tags), bool)
    is_moved[moved] = True
    for dimension, entity in [*gmsh.model.getEntities(1), *gmsh.model.getEntities(2)]:
        own = np.asarray(gmsh.model.mesh.getNodes(dimension, entity)[0], np.int64)
        own = own[is_moved[rows[own]]]
        if not len(own):
            continue
        places = points[rows[own]]
        try:
            parameters = np.asarray(gmsh.model.getParametrization(dimension, entity, places.ravel()))
            parameters = parameters.reshape(len(own), dimension)
        except Exception:  # noqa: BLE001
            # gmsh raises Exception. Entities without geometry, such as those of a mesh that was read, have no parameters.
            parameters = np.empty((len(own), 0))
        for tag, place, parameter in zip(own.tolist(), places.tolist(), parameters.tolist()):
            gmsh.model.mesh.setNode(tag, place, parameter)
