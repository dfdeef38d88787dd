"""Smoothing of arrays, and of the meshes of other packages."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, TypeVar, overload

from gpu_smooth import _native
from gpu_smooth._result import Result

if TYPE_CHECKING:
    from typing_extensions import Unpack

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
    points : array_like of float, shape (n, 2) or (n, 3)
        Positions of the vertices.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0.
    **options
        Options that belong to the mesh: `fixed`, `lines`, `regions`, `slide`, `corner_angle`, `hausdorff`, `periodic`,
        `keep_layers`, `only_bad`, `rings`, `target`, `target_rings`, `target_of`, `surface`, `z` and `untangle`.
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

    def __init__(self, points: Array, triangles: Array, **options: Unpack[MeshOptions]) -> None:
        run_options = sorted(set(options) & RUN_OPTIONS)
        if run_options:
            raise TypeError(f"{run_options[0]!r} is an option of a run: pass it to Smoother.run")
        self._native = _native.Smoother(points, triangles, **options)

    def run(self, **options: Unpack[RunOptions]) -> Result:
        """Smooth the mesh, from the points that were passed to the constructor.

        Parameters
        ----------
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
        MeshError, OptionError, DeviceError
            As `smooth` does.
        """
        return Result(self._native.run(**options))

    @property
    def free(self) -> Any:
        """Whether each vertex is free: inside of the mesh and not fixed; of shape (n,), bool."""
        return self._native.free

    def __repr__(self) -> str:
        free = self.free
        return f"Smoother({len(free)} vertices, {free.sum()} free, {len(self.triangles)} triangles)"

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


MESH_OPTIONS = frozenset(_native.mesh_options())
RUN_OPTIONS = frozenset(_native.run_options())


@overload
def smooth(points: Array, triangles: Array, **options: Unpack[SmoothOptions]) -> Floats: ...
@overload
def smooth(points: Mesh, triangles: None = None, **options: Unpack[SmoothOptions]) -> Mesh: ...
def smooth(points: Any, triangles: Any = None, **options: Any) -> Any:
    """Move the interior vertices of a mesh so that its triangles get better shapes, and return the new points.

    No triangle is ever inverted. The boundary stays unless `slide` is set. Arrays are not changed.

    Parameters
    ----------
    points : array_like of float, shape (n, 2) or (n, 3); or a mesh
        Positions of the vertices, in any unit. Vertices with three coordinates lie in one plane of any orientation, and
        are moved in the plane; `z` makes exceptions. The result has the same shape, and is float32 if the array is. In
        place of both arrays, a `meshio.Mesh`, a `pyvista.UnstructuredGrid` or a `pyvista.PolyData` may be passed. A
        mesh of the same kind is then returned, with all other cells, groups and data. Vertices of other cells and
        between regions stay.
    triangles : array_like of int, shape (m, 3)
        Vertices of each triangle, numbered from 0, in either winding.
    fixed : array_like, shape (k,) of int or (n,) of bool, optional
        Vertices that neither move nor slide. For a `meshio.Mesh`, also the name of a group, or a list of names.
    lines : array_like of int, shape (k, 2), optional
        Edges of triangles, such as those on a line between two materials. Their vertices stay, or slide along the lines.
    regions : array_like of int, shape (m,), optional
        Region of each triangle. Vertices between regions stay, or slide along the lines between regions.
    slide : bool, default False
        Let vertices of the boundary, of `lines` and between regions slide along them, from corner to corner. Two vertices
        with equal coordinates, as on both sides of a crack, slide together.
    corner_angle : float, default 40
        With `slide`: a vertex where a line turns by more degrees is a corner, and stays.
    hausdorff : float, optional
        With `slide`: the largest distance of the new lines from the given ones, in the unit of the points. The default is
        a tenth of the local edge length.
    periodic : array_like of int, shape (k, 2), optional
        With `slide`: pairs of vertices that slide together.
    keep_layers : str or tuple of str and array_like, default "auto"
        Boundary layers whose vertices stay: `"auto"` for the layers that are found above walls, `"none"`, `"rows=N"` for
        the first N rows, or `"within=DISTANCE"` for all vertices within a distance of walls, in the unit of the points.
        Walls are the boundary, `lines` and lines between regions; a tuple such as `("rows=3", walls)` has the vertices of
        the only walls that count, as `fixed` takes vertices. For a `meshio.Mesh`, `"rows=3,GROUP"` names groups of walls.
        If no other vertex is free, the points do not move, and a warning says so.
    only_bad : float, optional
        Let only vertices move that are near a triangle with a larger inverse mean ratio.
    rings : int, default 2
        With `only_bad`: number of rings of triangles that count as near.
    target : str, array_like or tuple, default "equilateral"
        Wanted elements: `"equilateral"` of any size, `"keep-size"` or `"keep-shape"` as in the given mesh (with
        `"keep-size"`, sizes weigh more on stretched meshes); an array of
        shape (n,) with edge lengths, or of shape (n, 3) with tensors (xx, xy, yy) under which elements are equilateral
        with edges of length 1 (x and y are `Result.axes` in other planes); or a tuple (points, triangles, array) with such an array on another mesh. Only ratios of
        sizes matter.
    target_rings : int, optional
        With `"keep-size"` and `"keep-shape"`: number of rings over which sizes and shapes are averaged. The default is 0
        for sizes and 1 for shapes.
    target_of : {"vertex", "place"}, optional
        Whether targets move with the vertices, or belong to places. The default is "place" for targets of another mesh,
        else "vertex".
    surface : {"plane", "sphere"}, default "plane"
        Meaning of the coordinates: lengths, or longitude and latitude in degrees.
    z : {"coordinate", "data"}, default "coordinate"
        Meaning of third coordinates that differ. "coordinate": the mesh lies in a plane of any orientation, is smoothed in
        it, and a curved surface is refused. "data": z is data of a mesh in x and y, such as depths, and each vertex keeps
        its z. On the sphere, z is data.
    untangle : bool, default False
        Untangle the mesh first if triangles are inverted or flat.
    scheme : str or sequence of str, optional
        A metric, or several metrics in turn, such as `"imr"` or `"edge+imr"`; `metrics` lists them. The default is
        `"imr"`, `"tmop-94"` for `"keep-size"`, and `"soft-size"` for given sizes.
    engine : {"auto", "cpu", "gpu"}, default "auto"
        Where to compute. "auto" takes a GPU if the run is estimated to end sooner, and never a software adapter.
    adapter : str, optional
        Text in the name of the GPU adapter; `adapters` lists them.
    max_sweeps : int, default 1000
        Largest number of sweeps.
    tolerance : float, default 1e-6
        The run ends when the estimated distance of f to its limit, relative to f, is below.
    fraction : float, optional
        In place of `tolerance`: share of the way from the initial to the desired f, above 0 and at most 1.
    desired : float or "auto", optional
        The desired f; "auto" finds it by a run before. `fraction` is 0.95 by default with `desired`.
    time_limit : float, optional
        Seconds after which the run ends with the best points so far.
    method : {"auto", "multilevel", "relaxed", "paper"}, default "auto"
        Sweeps with Newton steps of all vertices (CPU) or corrections from coarser levels (GPU), over-relaxed sweeps, or the
        method of Park & Shontz.
    omega : float, optional
        Factor of over-relaxation, above 0 and below 2.
    inner : int, default 1
        Newton steps per visit of a vertex, from 1 to 1000, by method "paper".
    derivatives : {"analytic", "finite-difference"}, default "analytic"
        Derivatives of the metrics, by method "paper".
    edge_norm : {"fixed", "continued"}, optional
        Exponent of the p-norm that replaces the metric edge.
    guard : {"by-metric", "worst"}, default "by-metric"
        "worst" lets no triangle become worse than the worst one before the run.
    improve_worst : bool or {"imr", "min-angle", "altitude"}, default False
        Improve the worst triangles after the last sweep, by the inverse mean ratio (also True), angle or altitude.
        "min-angle" is not for solvers that need orthogonal meshes, as angles above 90 degrees become more.
    max_move : float, optional
        Largest distance of a vertex from its place, in mean lengths of its edges.
    keep_altitude : bool, default False
        Let no altitude fall below the least one before the run, which bounds the time step of explicit solvers.
    history : {"base", "all"}, default "base"
        Whether the history of a result has f by the first metric, or by all metrics.
    on_sweep : callable, optional
        Called with a `Progress` between sweeps, about ten times a second. A true result or `StopIteration` ends the run
        with the best points so far; any other exception ends the run and is raised.
    checkpoint : str, bytes or path-like, optional
        File to which the state of the run is saved, from which `resume` continues. A completed run removes the file.
    checkpoint_every : float, default 300
        With `checkpoint` or `resume`: seconds between two checkpoints. A run that is ended by `time_limit`, `on_sweep` or
        an exception saves its state too.
    resume : str, bytes or path-like, optional
        Continue the run that saved this checkpoint, on the same mesh with the same options. The state is saved to the
        same file, unless `checkpoint` names another. On the CPU, or on the GPU of the saved run, the new points have the
        bits of an uninterrupted run.

    Returns
    -------
    numpy.ndarray or mesh
        The new points, or a mesh of the kind that was passed.

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


def run(points: Array, triangles: Array, **options: Unpack[SmoothOptions]) -> Result:
    """Smooth a mesh, and return the new points with a report.

    Parameters
    ----------
    points : array_like of float, shape (n, 2) or (n, 3)
        Positions of the vertices.
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
    of_mesh = {name: all_options.pop(name) for name in list(all_options) if name in MESH_OPTIONS}
    return Smoother(points, triangles, **of_mesh).run(**all_options)
