"""Functions on arrays beside smoothing."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from gpu_smooth import _native
from gpu_smooth._errors import MeshError
from gpu_smooth._native import Quality

if TYPE_CHECKING:
    from gpu_smooth._options import Array, Doubles, Floats, Surface, ThirdCoordinate
    from gpu_smooth._progress import Progress


def quality(
    points: Array | Any,
    triangles: Array | None = None,
    measure: str = "imr",
    *,
    quadrilaterals: Array | None = None,
    surface: Surface | None = None,
    z: ThirdCoordinate = "coordinate",
) -> Doubles:
    """Return the quality of each triangle and quadrilateral by a measure.

    Parameters
    ----------
    points : array_like of float, shape (n, 2) or (n, 3); or a mesh
        Positions of the vertices. In place of both arrays, a mesh that `smooth` takes may be passed.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0.
    quadrilaterals : array_like of int, shape (k, 4), optional
        Vertices of each quadrilateral, around it in either direction. A mesh in place of both arrays has its own.
    measure : str, default "imr"
        Name of a measure or metric, such as `"min-angle"`; `measures` lists them with their sources.
    surface : {"plane", "sphere"}, optional
        Meaning of the coordinates: lengths, or longitude and latitude in degrees. The default is the surface that the mesh
        states, else the plane.
    z : {"coordinate", "data"}, default "coordinate"
        Meaning of third coordinates, as in `smooth`.

    Returns
    -------
    numpy.ndarray of float64, shape (m + k,)
        Values of the triangles, then of the quadrilaterals. Angles in degrees, other measures without a unit. Infinite for a
        flat triangle if the measure is unbounded. NaN for quadrilaterals if only triangles have the measure.

    Raises
    ------
    MeshError
        The arrays have a wrong shape or type, or are no mesh.
    OptionError
        No measure has the name.

    Examples
    --------
    >>> import gpu_smooth
    >>> gpu_smooth.quality([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]], "max-angle").tolist()
    [90.0]
    """
    if isinstance(triangles, str):
        raise MeshError(
            f"triangles: an array is needed, not text. Name the measure: quality(mesh, measure={triangles!r})"
        )
    if triangles is None:
        from gpu_smooth import _meshes

        if quadrilaterals is not None:
            raise MeshError("quadrilaterals: a mesh in place of the arrays has its own. Drop them, or pass arrays")
        points, cells = _meshes.points_and_cells(points)
        triangles, quadrilaterals, surface = cells.triangles, cells.quadrilaterals, surface or cells.surface
    return _native.quality(points, (triangles, quadrilaterals), measure, surface or "plane", z)


def untangle(
    points: Array,
    triangles: Array,
    *,
    quadrilaterals: Array | None = None,
    fixed: Array | None = None,
    z: ThirdCoordinate = "coordinate",
    keep_going: bool = False,
    time_limit: float | None = None,
    on_sweep: Callable[[Progress], object] | None = None,
) -> Floats:
    """Move free vertices until no triangle is inverted or flat and all quadrilaterals are convex, and return the new points.

    The boundary stays. If moves near the bad elements suffice, all other vertices keep their points.

    Parameters
    ----------
    points : array_like of float, shape (n, 2) or (n, 3)
        Positions of the vertices.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0. Windings are made consistent first.
    quadrilaterals : array_like of int, shape (k, 4), optional
        Vertices of each quadrilateral, around it in either direction.
    fixed : array_like, shape (k,) of int or (n,) of bool, optional
        Vertices that stay.
    z : {"coordinate", "data"}, default "coordinate"
        Meaning of third coordinates, as in `smooth`.
    keep_going : bool, default False
        Return the best points found if elements stay inverted, in place of an exception.
    time_limit : float, optional
        Seconds after which untangling ends.
    on_sweep : callable, optional
        Called with a `Progress` after each sweep, whose `value` is the number of bad triangles and corners of
        quadrilaterals. A true result ends
        untangling.

    Returns
    -------
    numpy.ndarray
        New points, in the shape and the type of `points`.

    Raises
    ------
    MeshError
        The arrays are no mesh, or elements stay inverted, flat or concave; the attributes `triangles` and `quadrilaterals` list
        them.

    Notes
    -----
    The energy is by Garanzha et al., *Foldover-free maps in 50 lines of code*, ACM Transactions on Graphics 40 (2021).
    No method is known that untangles every mesh that can be untangled.

    Examples
    --------
    >>> import gpu_smooth
    >>> points = [[0, 0], [2, 0], [2, 2], [0, 2], [3.5, 1.2]]
    >>> triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    >>> points = gpu_smooth.untangle(points, triangles)
    >>> bool((gpu_smooth.quality(points, triangles, "scaled-jacobian") > 0).all())
    True
    """
    return _native.untangle(points, (triangles, quadrilaterals), fixed, z, keep_going, time_limit, on_sweep)


def interpolate(
    points: Array,
    triangles: Array,
    moved: Array,
    values: Array,
    *,
    quadrilaterals: Array | None = None,
    surface: Surface = "plane",
    z: ThirdCoordinate = "coordinate",
) -> Doubles:
    """Return data of vertices at new positions of the vertices.

    The data are linear in each triangle of the mesh before the move, and bilinear in each quadrilateral. A vertex that
    has not moved keeps the bits of its data.

    Parameters
    ----------
    points : array_like of float, shape (n, 2) or (n, 3)
        Positions of the vertices before the move.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0.
    moved : array_like of float, shape (n, 2) or (n, 3)
        New positions of the vertices.
    values : array_like of float, shape (n,) or (n, k)
        Data of the vertices, such as depths.
    quadrilaterals : array_like of int, shape (k, 4), optional
        Vertices of each quadrilateral, around it in either direction.
    surface : {"plane", "sphere"}, default "plane"
        Meaning of the coordinates, as in `smooth`.
    z : {"coordinate", "data"}, default "coordinate"
        Meaning of third coordinates, as in `smooth`.

    Returns
    -------
    numpy.ndarray of float64
        Data at the new positions, in the shape of `values`.

    Raises
    ------
    MeshError
        The arrays have a wrong shape or type, or elements before the move are inverted, flat or concave.

    Examples
    --------
    >>> import gpu_smooth
    >>> points = [[0, 0], [2, 0], [2, 2], [0, 2], [1.5, 1]]
    >>> triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    >>> moved = [[0, 0], [2, 0], [2, 2], [0, 2], [1, 1]]
    >>> gpu_smooth.interpolate(points, triangles, moved, [0, 2, 2, 0, 1.5]).tolist()
    [0.0, 2.0, 2.0, 0.0, 1.0]
    """
    return _native.interpolate(points, (triangles, quadrilaterals), moved, values, surface, z)


class Spread(NamedTuple):
    """Distribution of a number over vertices."""

    median: float
    p95: float
    """95th percentile."""
    most: float


class Comparison(NamedTuple):
    """Difference between two states of a mesh."""

    vertices_moved: int
    """Number of vertices whose x or y differ, or whose coordinates in another plane differ."""
    z_changed: bool
    """Whether z of a mesh in x and y differs, or a vertex has left the plane of a mesh in another plane."""
    moved: Spread
    """Displacement of vertices, divided by the mean length of their edges before."""
    size_change: Spread
    """Factor by which the size of the elements around a vertex grew or shrank, 1 or more."""
    least_altitude: tuple[float, float]
    """Least altitude of a triangle or of a corner of a quadrilateral before and after, in the unit of the points."""
    quality_before: Quality
    quality_after: Quality


def compare(
    before: Array,
    after: Array,
    triangles: Array,
    *,
    quadrilaterals: Array | None = None,
    surface: Surface = "plane",
    z: ThirdCoordinate = "coordinate",
) -> Comparison:
    """Compare two states of a mesh: how far vertices moved, and how sizes and quality changed.

    Parameters
    ----------
    before, after : array_like of float, shape (n, 2) or (n, 3)
        Positions of the vertices in the two states.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0.
    quadrilaterals : array_like of int, shape (k, 4), optional
        Vertices of each quadrilateral, around it in either direction.
    surface : {"plane", "sphere"}, default "plane"
        Meaning of the coordinates.
    z : {"coordinate", "data"}, default "coordinate"
        Meaning of third coordinates, as in `smooth`.

    Returns
    -------
    Comparison

    Raises
    ------
    MeshError
        The arrays have a wrong shape or type, or are no mesh.
    """
    found = _native.compare(before, after, (triangles, quadrilaterals), surface, z)
    spreads = {name: Spread(*found[name]) for name in ("moved", "size_change")}
    return Comparison(**(found | spreads))


class Metric(NamedTuple):
    """A metric q. Smoothing minimizes f, the mean of q² over all triangles and quadrilaterals."""

    name: str
    formula: str
    """L are edge lengths, S is the area."""
    purpose: str
    ideal: float
    """q of an equilateral triangle of mean area."""
    has_barrier: bool
    """Whether q grows without bound as a triangle becomes flat."""
    is_scale_invariant: bool
    omega: float
    """Factor of over-relaxation in runs by this metric alone."""
    source: str


class Measure(NamedTuple):
    """A quality measure of triangles."""

    name: str
    formula: str
    """L are edge lengths, S is the area, r the inradius, R the circumradius."""
    unit: str
    """`"°"` for angles, empty for ratios."""
    range: tuple[float, float]
    """Least and largest value of a triangle."""
    ideal: float
    """Value of the best triangle."""
    better: Literal["higher", "lower"]
    """Whether large or small values are better."""
    source: str


class Adapter(NamedTuple):
    """A GPU adapter of this machine."""

    name: str
    driver: str
    backend: str
    """`"vulkan"`, `"metal"`, `"dx12"` or `"gl"`."""
    kind: str
    """`"discrete GPU"`, `"integrated GPU"`, `"virtual GPU"`, `"CPU"` (software) or `"other"`."""
    is_software: bool
    problem: str | None
    """Reason why the adapter cannot be used; None if it can."""


def metrics() -> list[Metric]:
    """Return all metrics, with formulas, purposes and sources.

    Examples
    --------
    >>> import gpu_smooth
    >>> [metric.name for metric in gpu_smooth.metrics()][:3]
    ['edge', 'area', 'rms']
    """
    return [Metric(**row) for row in _native.metrics()]


def measures() -> list[Measure]:
    """Return all quality measures, with formulas, ranges and sources; metrics are measures too."""
    return [Measure(**row) for row in _native.measures()]


def adapters() -> list[Adapter]:
    """Return the GPU adapters of this machine, in order of preference, each opened and checked.

    Raises
    ------
    DeviceError
        The process was forked after a GPU was used.
    """
    return [Adapter(**row) for row in _native.adapters()]
