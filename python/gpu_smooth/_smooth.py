"""Smoothing of arrays, and of the meshes of other packages."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, TypeVar, overload

from gpu_smooth import _native
from gpu_smooth._result import Result

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from gpu_smooth._files import MeshFile
    from gpu_smooth._options import (
        Array,
        Floats,
        Integers,
        MeshOptions,
        RunOptions,
        SmoothOptions,
    )

Mesh = TypeVar("Mesh")


class Smoother:
    """Mesh prepared once for any number of runs.

    Parameters
    ----------
    points : array_like of float, shape (n, 2) or (n, 3); or a mesh
        Positions of the vertices. In place of both arrays, a mesh that `smooth` takes may be passed.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0.
    **options
        Options that belong to the mesh: `quadrilaterals`, `fixed`, `lines`, `regions`, `slide`, `corner_angle`, `hausdorff`, `periodic`,
        `free_lines`, `keep_layers`, `only_bad`, `rings`, `target`, `target_rings`, `target_of`, `surface`, `z` and `untangle`.
        `smooth` describes each.

    Raises
    ------
    MeshError, OptionError
        As `smooth` does.

    Examples
    --------
    >>> import gpu_smooth
    >>> points = [[0, 0], [2, 0], [2, 2], [0, 2], [1.5, 1.2]]
    >>> triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    >>> smoother = gpu_smooth.Smoother(points, triangles)
    >>> smoother.free.tolist()
    [False, False, False, False, True]
    >>> smoother.run(scheme="edge").stop
    'converged'
    """

    def __init__(
        self, points: Array | Any, triangles: Array | None = None, **options: Unpack[MeshOptions]
    ) -> None:
        run_options = sorted(set(options) & RUN_OPTIONS)
        if run_options:
            raise TypeError(f"{run_options[0]!r} is an option of a run: pass it to Smoother.run")
        of_mesh: dict[str, Any] = dict(options)
        self._with_points = None
        if triangles is None:
            from gpu_smooth import _meshes

            points, triangles, of_mesh, self._with_points = _meshes.arrays_of(points, of_mesh)
        self._native = _native.Smoother(points, triangles, **of_mesh)

    def run(self, points: Array | None = None, **options: Unpack[RunOptions]) -> Result:
        """Smooth the mesh, from other points or from those that were passed to the constructor.

        Parameters
        ----------
        points : array_like of float, shape (n, 2) or (n, 3), optional
            New positions of all vertices, such as after a step of a moving boundary, in the plane of the points that were
            passed to the constructor. Fixed vertices and the boundary may be anywhere. Elements, fixed vertices and boundary
            layers are those of the constructor; targets and the lines along which vertices slide are those of the new points.
            A mesh that is tangled there is untangled first if the constructor was called with `untangle=True`. The
            result is that of a new `Smoother` within `tolerance`, as vertices may be visited in another order.
        **options
            Options of a run: `scheme`, `engine`, `adapter`, `max_sweeps`, `tolerance`, `fraction`, `desired`,
            `time_limit`, `method`, `omega`, `inner`, `derivatives`, `edge_norm`, `guard`, `improve_worst`, `max_move`,
            `keep_altitude`, `history`, `on_sweep`, `checkpoint`, `checkpoint_every` and `resume`. `smooth` describes
            each.

        Returns
        -------
        Result

        Raises
        ------
        MeshError
            As `smooth` does, such as for triangles that are inverted at `points` (`MeshError.triangles`).
        OptionError
            As `smooth` does, and if `points` goes with `checkpoint`, `resume`, `only_bad` or `surface="sphere"`.
        DeviceError
            As `smooth` does.

        Examples
        --------
        >>> import gpu_smooth
        >>> import numpy as np
        >>> points = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1.5, 1.2]])
        >>> triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
        >>> smoother = gpu_smooth.Smoother(points, triangles)
        >>> for step in range(10):
        ...     points[[1, 2], 0] += 0.2
        ...     points = smoother.run(points).points
        >>> points[4].round(3).tolist()
        [2.0, 1.0]
        """
        return Result(self._native.run(points, **options), self._with_points)

    @property
    def free(self) -> Any:
        """Whether each vertex is free: inside of the mesh and not fixed; of shape (n,), bool."""
        return self._native.free

    def __repr__(self) -> str:
        free = self.free
        others = f", {len(self.quadrilaterals)} quadrilaterals" if len(self.quadrilaterals) else ""
        return f"Smoother({len(free)} vertices, {free.sum()} free, {len(self.triangles)} triangles{others})"

    # A prepared mesh does not change, so that copies may share it.
    def __copy__(self) -> Smoother:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Smoother:
        return self

    def __reduce__(self) -> Any:
        raise TypeError("a Smoother cannot be pickled: make one in each process, from points and triangles")

    @functools.cached_property
    def triangles(self) -> Integers:
        """Vertices of each triangle, of shape (m, 3), counter-clockwise."""
        return self._native.triangles

    @functools.cached_property
    def quadrilaterals(self) -> Integers:
        """Vertices of each quadrilateral, of shape (k, 4), counter-clockwise."""
        return self._native.quadrilaterals


RUN_OPTIONS = frozenset(_native.run_options())


@overload
def smooth(points: Array, triangles: Array, **options: Unpack[SmoothOptions]) -> Floats: ...
@overload
def smooth(points: MeshFile, triangles: None = None, **options: Unpack[SmoothOptions]) -> Floats: ...
@overload
def smooth(points: Mesh, triangles: None = None, **options: Unpack[SmoothOptions]) -> Mesh: ...
def smooth(points: Any, triangles: Any = None, **options: Any) -> Any:
    """Move the interior vertices of a mesh so that its triangles and quadrilaterals get better shapes, and return the new points.

    No triangle is ever inverted, and no quadrilateral loses its convexity. The boundary stays unless `slide` is set. Arrays are
    not changed.

    Parameters
    ----------
    points : array_like of float, shape (n, 2) or (n, 3); or a mesh
        Positions of the vertices, in any unit. Vertices with three coordinates lie in one plane of any orientation, and
        are moved in the plane; `z` makes exceptions. The result has the same shape, and is float32 if the array is. In
        place of both arrays, a `meshio.Mesh`, a `pyvista.UnstructuredGrid`, a `pyvista.PolyData`, a `skfem.MeshTri` or
        `MeshQuad`, a `meshkernel.Mesh2d`, or a `Ugrid2d`, `UgridDataset` or `UgridDataArray` of xugrid may be passed. A mesh of
        the same kind is then returned, with all other cells, groups and data. Vertices of cells other than triangles and
        quadrilaterals, of boundaries of scikit-fem, and between regions stay. A `MeshFile` may be passed too; the new points are
        then returned, for `MeshFile.write`.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0, in either winding. An empty list for a mesh of quadrilaterals alone.
    quadrilaterals : array_like of int, shape (k, 4), or {"keep", "move"}, optional
        Vertices of each quadrilateral, around it in either direction. It must be convex, unless `untangle` is set. For a mesh in
        place of the arrays, whether the vertices of its quadrilaterals move, or all stay. They move by default. Quadrilaterals
        that list a vertex twice stay anyway.
    fixed : array_like, shape (k,) of int or (n,) of bool, optional
        Vertices that neither move nor slide. For a mesh with named groups, also the name of a group, or a list of names.
    lines : array_like of int, shape (k, 2), optional
        Edges of triangles, such as those on a line between two materials. Their vertices stay, or slide along the lines. A pair
        that is no edge of the mesh is a warning.
    regions : array_like of int, shape (m,) or (m + k,), optional
        Region of each triangle, then of each quadrilateral. Vertices between regions stay, or slide along the lines between regions.
    slide : bool, default False
        Let vertices of the boundary, between regions and on lines slide along them, from corner to corner. Straight
        lines stay straight; on other lines, vertices follow a cubic through the vertices of the given mesh. Two
        vertices with equal coordinates, as on both sides of a crack, slide together.
    corner_angle : float, default 40
        A vertex where a line turns by more than this angle is a corner, and stays where it is.
    hausdorff : float, optional
        Largest distance of lines from the lines of the given mesh, in the unit of the mesh. The default is a tenth of
        the local edge length.
    periodic : array_like of int, shape (k, 2), optional
        With `slide`: pairs of vertices that slide together. A pair with a vertex inside the mesh, and a pair of a corner and
        another vertex, are a warning and do not slide.
    keep_layers : str or tuple of str and array_like, default "auto"
        Boundary layers whose vertices stay: `"auto"` for the layers that are found above walls, `"none"`, `"rows=N"` for
        the first N rows, or `"within=DISTANCE"` for all vertices within a distance of walls, in the unit of the points.
        Walls are the boundary, `lines` and lines between regions; a tuple such as `("rows=3", walls)` has the vertices of
        the only walls that count, as `fixed` takes vertices. Without such vertices, `"rows=N"` and `"within=DISTANCE"` take
        each wall, from corner to corner, with flat elements at a quarter of its vertices or more, and of other walls the vertices
        with flat elements. For a mesh with named groups, `"rows=3,GROUP"` names groups of walls.
        If no other vertex is free, the points do not move, and a warning says so.
    free_lines : bool, default False
        Let vertices on lines inside of the mesh move, and not slide along these lines: for files that list all edges of
        the mesh as lines, as some converters write them. Vertices on the boundary, between regions, on points and on
        elements other than lines stay.
    only_bad : float, optional
        Let only vertices move that are near a triangle with an inverse mean ratio above this number.
    rings : int, default 2
        Number of rings of triangles, around the bad triangles of `only_bad`, that count as near.
    target : str, array_like or tuple, default "equilateral"
        Wanted elements: `"equilateral"` of any size, `"keep-size"` or `"keep-shape"` as in the given mesh (with
        `"keep-size"`, sizes weigh more on stretched meshes); an array of
        shape (n,) with edge lengths, or of shape (n, 3) with tensors (xx, xy, yy) under which elements are equilateral
        with edges of length 1 (x and y are `Result.axes` in other planes); or a tuple (points, triangles, array) with such an array on another mesh. Only ratios of
        sizes matter.
    target_rings : int, optional
        Over how many rings of neighbors the sizes and shapes to keep are averaged: more leave less of the mesh's noise.
        The default is 1 for keep-shape, 0 for keep-size.
    target_of : {"vertex", "place"}, optional
        Owner of targets: vertices, which carry them along, or places, so that targets are evaluated again at the new
        positions of vertices. The default is place for targets on another mesh, else vertex.
    surface : {"plane", "sphere"}, default "plane"
        Meaning of coordinates: lengths in the plane, or longitude and latitude in degrees on a sphere, continued across
        the meridian at which longitudes wrap.
    z : {"coordinate", "data"}, default "coordinate"
        Meaning of third coordinates that differ: a coordinate of a mesh that lies in any plane and is smoothed in it,
        or data of a mesh in x and y, such as depths. A mesh on a curved surface is refused unless z is data. Each
        vertex keeps its z if z is data, as it is on the sphere.
    untangle : bool, default False
        Untangle the mesh first if triangles are inverted or flat: move free vertices until no triangle is. Done on the
        CPU.
    scheme : str or sequence of str, optional
        The metric to minimize, or several in turn, sweep by sweep until corrections begin, as in edge+imr; the first
        judges convergence. Metrics: edge, area, rms, imr, ar, shape-size, soft-size, tmop-80, tmop-94, tmop-2, acute,
        acute-size. Several metrics may also be a list. `metrics` describes each. The default is imr, tmop-94 for
        `target="keep-size"`, and soft-size for given sizes.
    engine : {"auto", "gpu", "cpu"}, default "auto"
        Where to compute: on a GPU adapter, even if it is software (gpu), on the CPU (cpu), or where the run is
        estimated to be done first, but not on a software adapter (auto).
    adapter : str, optional
        Take the first GPU adapter with this text in its name. `adapters` lists them.
    max_sweeps : int, default 1000
        Stop after this many sweeps at the latest.
    tolerance : float, optional
        Stop when f is estimated to be within this share of its limit; 0 to go on to the last sweep. The default is
        1e-6, 1e-4 by acute, and 1e-3 by acute with `slide`.
    fraction : float, optional
        Stop after this fraction of the reduction from the initial f to the desired f, instead of at the tolerance. Park
        & Shontz use 0.95. The default is 0.95 with `desired`.
    desired : float or "auto", optional
        The desired f by the first metric; auto finds the optimum before the run, in tries of up to 5000 sweeps. The
        default is auto with `fraction`.
    time_limit : float, optional
        Stop after this many seconds, with the best mesh so far. The time counts from the call, also while the mesh is
        prepared and untangled; with a `Smoother`, from the call of its `run`. A mesh that is still being untangled then
        is a `MeshError`.
    method : {"auto", "multilevel", "relaxed", "paper"}, default "auto"
        Sweeps with Newton steps of all vertices or corrections from coarser levels of the mesh, by all metrics but area
        (multilevel), over-relaxed sweeps (relaxed), or the plain sweeps of Park & Shontz (paper). auto takes relaxed
        with `omega`, paper with `inner` or `derivatives`, and otherwise multilevel where the scheme allows corrections.
    omega : float, optional
        Over-relaxation factor of `method="relaxed"`, above 0 and below 2. The default is by metric; 1 if metrics
        alternate.
    inner : int, default 1
        Newton steps per visit of a vertex, by `method="paper"`.
    derivatives : {"analytic", "finite-difference"}, default "analytic"
        How `method="paper"` differentiates metrics; finite differences only serve to test the paper's cost model.
    edge_norm : {"fixed", "continued"}, optional
        Exponent of the p-norm that replaces edge in Newton steps: 16 throughout (fixed), or doubled from 2 up to 8192
        (continued; 512 without corrections from coarser levels), which reaches a lower f. The default is continued with
        corrections, fixed without.
    guard : {"by-metric", "worst"}, default "by-metric"
        Bound on the inverse mean ratio of triangles after a step, measured under the `target`: by-metric bounds only
        metrics without a barrier; worst lets no triangle exceed the initial maximum of the triangles with a free
        vertex.
    improve_worst : bool or {"imr", "min-angle", "altitude"}, default False
        Improve the worst triangles after the last sweep, at a small cost in f: move the vertices around the worst
        thousandth of the triangles until the largest imr is as small as it can be made, or the least angle or altitude
        as large. Least angles grow at the cost of angles above 90 degrees, so min-angle is not for solvers that need
        orthogonal meshes. True stands for imr.
    max_move : float, optional
        Let no vertex move farther than this many times the mean length of the edges around it before the run.
    keep_altitude : bool, default False
        Let no triangle's altitude fall below the least altitude of the given mesh, which bounds the time step of
        explicit solvers.
    history : {"base", "all"}, default "base"
        Which f the history of a run has: that of the first metric (base), or those of all metrics (all).
    on_sweep : callable, optional
        Called with a `Progress` between sweeps, about ten times a second. A true result or `StopIteration` ends the run
        with the best points so far; any other exception ends the run and is raised.
    checkpoint : str, bytes or path-like, optional
        File to which the state of the run is saved, from which `resume` continues. A completed run removes the file.
    checkpoint_every : float, default 300
        The time between two checkpoints. A run that is ended early saves its state too.
    resume : str, bytes or path-like, optional
        Continue the run that saved this checkpoint, on the same mesh with the same options. The state is saved to the
        same file, unless `checkpoint` names another. On the CPU, or on the GPU of the saved run, the new points have the
        bits of an uninterrupted run.

    Returns
    -------
    numpy.ndarray or mesh
        The new points, or a mesh of the kind that was passed; the new points of a `MeshFile`.

    Raises
    ------
    MeshError
        The arrays have a wrong shape or type, or are no mesh that can be smoothed. A `ValueError`.
    OptionError
        An option has a wrong value, two options exclude each other, or the checkpoint is of another run. A `ValueError`.
    FileError
        The checkpoint cannot be read, or its file is another run's. An `OSError`.
    DeviceError
        The GPU that `engine` or `adapter` names cannot be used, or has failed. A `RuntimeError`. With `engine="auto"`, the
        run continues on the CPU.
    KeyboardInterrupt
        The user has pressed Ctrl-C. The run ends between two sweeps.

    Notes
    -----
    Python's global lock is released while the library works, so that other threads go on, also with other meshes.

    The method is by J. Park and S. M. Shontz, *An Alternating Mesh Quality Metric Scheme for Efficient Mesh Quality
    Improvement*, Procedia Computer Science 4 (2011) 292-301, with Newton steps of all vertices or corrections from coarser
    levels.

    Examples
    --------
    >>> import gpu_smooth
    >>> points = [[0, 0], [2, 0], [2, 2], [0, 2], [1.5, 1.2]]
    >>> triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    >>> gpu_smooth.smooth(points, triangles)[4].round(3).tolist()
    [1.0, 1.0]
    """
    if triangles is None:
        from gpu_smooth import _meshes

        return _meshes.smooth(points, options)
    return _native.smooth(points, triangles, **options)


def run(points: Array | Any, triangles: Array | None = None, **options: Unpack[SmoothOptions]) -> Result:
    """Smooth a mesh, and return the new points with a report.

    Parameters
    ----------
    points : array_like of float, shape (n, 2) or (n, 3); or a mesh
        Positions of the vertices. In place of both arrays, a mesh that `smooth` takes may be passed; `Result.mesh` is then a
        mesh of the same kind.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0.
    **options
        The options of `smooth`.

    Returns
    -------
    Result

    Raises
    ------
    MeshError, OptionError, DeviceError
        As `smooth` does.

    Examples
    --------
    >>> import gpu_smooth
    >>> points = [[0, 0], [2, 0], [2, 2], [0, 2], [1.5, 1.2]]
    >>> triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    >>> result = gpu_smooth.run(points, triangles)
    >>> result.stop, round(result.quality_after.min_angle)
    ('converged', 45)
    """
    all_options: dict[str, Any] = dict(options)
    _native.check_option_names(list(all_options))
    with_points = None
    if triangles is None:
        from gpu_smooth import _meshes

        points, triangles, all_options, with_points = _meshes.arrays_of(points, all_options)
    return Result(_native.run(points, triangles, **all_options), with_points)
