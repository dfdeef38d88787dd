"""The result of a run."""

from __future__ import annotations

import functools
import types
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from gpu_smooth import _picture
from gpu_smooth._native import Outcome, Quality

if TYPE_CHECKING:
    from gpu_smooth._options import Doubles, Floats, Integers


# Methods and properties of an outcome whose values a pickled result has.
_METHODS = (
    "triangles", "quadrilaterals", "points", "points_before", "flat_points", "flat_points_before", "chart_cells", "history",
    "quality_before", "quality_after",
)
_PROPERTIES = (
    "surface", "axes", "metric", "has_target", "engine", "stop", "fault", "remarks", "sweeps", "corrections", "newton_steps",
    "newton_iterations", "best_sweep", "movable_f", "remaining", "held_back", "slides", "frees_lines", "slid",
    "floored", "prepare_seconds", "seconds",
)


def _same(value: Any) -> Any:
    return value


class Result:
    """Result of a run: new points, and a report.

    A notebook shows the result as a picture. `run` and `Smoother.run` return results. A result may be pickled.
    """

    def __init__(self, outcome: Outcome, with_points: Callable[[Any], Any] | None = None) -> None:
        self._outcome = outcome
        self._with_points = with_points
        self.points: Floats = outcome.points()
        """Points after the run, in the shape and the type of the points that were passed."""

    @functools.cached_property
    def triangles(self) -> Integers:
        """Vertices of each triangle, of shape (m, 3), counter-clockwise."""
        return self._outcome.triangles()

    @functools.cached_property
    def quadrilaterals(self) -> Integers:
        """Vertices of each quadrilateral, of shape (k, 4), counter-clockwise."""
        return self._outcome.quadrilaterals()

    @property
    def mesh(self) -> Any:
        """Mesh of the kind that was passed, with moved vertices and with all other cells, groups and data.

        A copy with each access. None if arrays were passed, or a `MeshFile`, which `MeshFile.write` writes with `points`.
        """
        return None if self._with_points is None else self._with_points(self.points)

    @functools.cached_property
    def points_before(self) -> Floats:
        """Points before the run, in the shape and the type of `points`."""
        return self._outcome.points_before()

    @property
    def displacement(self) -> Floats:
        """Vectors from the points before the run to `points`, in the shape of `points`.

        The shorter way around, for a vertex on the sphere that has crossed the line where longitudes jump.
        """
        moved: Floats = self.points - self.points_before
        if self._outcome.surface == "sphere":
            moved[:, 0] -= 360.0 * np.round(moved[:, 0] / 360.0)
        return moved

    @property
    def axes(self) -> tuple[str, str]:
        """Names of the two coordinates in which vertices were moved.

        `("x", "y")`, `("x", "z")` or `("y", "z")`; or `("u", "v")` in a tilted plane, where u and v are lengths from the
        mean of all vertices.
        """
        return self._outcome.axes

    @functools.cached_property
    def histories(self) -> dict[str, Doubles]:
        """f before the first sweep and after each sweep, by each metric of the history; see the option `history`.

        With targets, f is measured relative to the targets. The run evaluates f in its own coordinates, on a GPU in single
        precision, and before it rounds points to the precision of the points that were passed. On slivers and far from the
        origin, f of `quality_before` and `quality_after`, which are evaluated at the points as passed and returned, differs.
        """
        return self._outcome.history()

    @property
    def history(self) -> Doubles:
        """f by the first metric of the scheme, of shape (sweeps + 1,): before the first sweep and after each sweep."""
        return self.histories.get(self.metric, np.empty(0))

    @functools.cached_property
    def quality_before(self) -> Quality:
        """Quality of the mesh before the run."""
        return self._outcome.quality_before()

    @functools.cached_property
    def quality_after(self) -> Quality:
        """Quality of the mesh after the run."""
        return self._outcome.quality_after()

    @property
    def metric(self) -> str:
        """Name of the first metric of the scheme, which judges the run."""
        return self._outcome.metric

    @property
    def has_target(self) -> bool:
        """Whether f of the history is measured relative to targets of size or shape."""
        return self._outcome.has_target

    @property
    def engine(self) -> str:
        """`"cpu"`, or the name of the GPU adapter on which the run began."""
        return self._outcome.engine

    @property
    def stop(self) -> str:
        """Reason why the run ended.

        `"converged"`, `"reached"` (the goal), `"stalled"`, `"held-back"` (by the guard), `"max-sweeps"`, `"canceled"` (by
        `on_sweep` or `time_limit`), `"not-finite"`, or `"nothing-to-do"` if all vertices stay, because `only_bad` finds no bad
        element or every free vertex is in a boundary layer that stays.
        """
        return self._outcome.stop

    @property
    def fault(self) -> str | None:
        """Failure of the GPU after which the run continued on the CPU; None if no GPU failed."""
        return self._outcome.fault

    @functools.cached_property
    def remarks(self) -> list[str]:
        """Remarks on the mesh and the run, such as vertices that stay or slide; those of a `MeshWarning` too."""
        return self._outcome.remarks

    @property
    def sweeps(self) -> int:
        """Number of sweeps done."""
        return self._outcome.sweeps

    @property
    def corrections(self) -> int:
        """Number of corrections from coarser levels."""
        return self._outcome.corrections

    @property
    def newton_steps(self) -> int:
        """Number of Newton steps of all vertices."""
        return self._outcome.newton_steps

    @property
    def newton_iterations(self) -> int:
        """Number of iterations of conjugate gradients in all Newton steps of all vertices."""
        return self._outcome.newton_iterations

    @property
    def best_sweep(self) -> int:
        """The sweep whose points were taken; 0 for the points before the run."""
        return self._outcome.best_sweep

    @property
    def movable_f(self) -> tuple[float, float]:
        """f over the triangles and quadrilaterals that can move, which judges the run, before and after the run."""
        return self._outcome.movable_f

    @property
    def remaining(self) -> float | None:
        """Estimated gain of further sweeps, as a share of f; None if unknown."""
        return self._outcome.remaining

    @property
    def held_back(self) -> int:
        """Number of vertices that a guard kept from moving further."""
        return self._outcome.held_back

    @property
    def slid(self) -> int:
        """Number of vertices that slid along lines."""
        return self._outcome.slid

    @property
    def floored(self) -> int:
        """Number of vertices that moved on or went back because the sweeps had made the worst triangles worse.

        By default, a run ends with no smaller angle and no larger inverse mean ratio than before, among the triangles that can
        move. 0 if the sweeps made neither worse, and with other schemes, methods and guards, with a target or a goal.
        """
        return self._outcome.floored

    @property
    def prepare_seconds(self) -> float:
        """Duration of the preparation of the mesh in seconds, which runs of a `Smoother` share.

        For a run at new points, the duration of the move of the prepared mesh to these points.
        """
        return self._outcome.prepare_seconds

    @property
    def seconds(self) -> float:
        """Duration of the run in seconds, without the preparation of the mesh."""
        return self._outcome.seconds

    def plot(
        self,
        which: Literal["before", "after", "both"] = "both",
        measure: str = "shape",
        ax: Any = None,
        picture_range: tuple[float, float] | None = None,
        **options: Any,
    ) -> Any:
        """Draw the mesh by matplotlib, each element colored by a measure. Inverted, flat and concave elements are red.

        Parameters
        ----------
        which : {"before", "after", "both"}
            The mesh before the run, after the run, or both side by side in equal colors.
        measure : str
            Name of a measure; see `measures`.
        ax : matplotlib.axes.Axes, optional
            Axes to draw in, for "before" or "after".
        picture_range : (float, float), optional
            Values of the measure between which colors change, as `--picture-range` of the command line. Further values have
            the color of the nearer one. By default, colors change where good meshes differ, such as from 0.5 to 1 by shape.
        **options
            Passed to `matplotlib.axes.Axes.tripcolor`, or to `matplotlib.collections.PolyCollection` for a mesh with
            quadrilaterals, such as `cmap`, `vmin` or `edgecolors`.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        ImportError
            matplotlib is not installed.
        OptionError
            No measure has the name, the measure has no such range, or quadrilaterals of the mesh do not have it.
        """
        return _picture.plot(self._subject(), which, measure, ax, picture_range, options)

    def show(
        self,
        which: Literal["before", "after", "both"] = "both",
        measure: str = "shape",
        picture_range: tuple[float, float] | None = None,
        **options: Any,
    ) -> None:
        """Draw the mesh as `plot` does, in a window, and wait until the window is closed.

        A notebook shows the picture below the cell.

        Parameters
        ----------
        which : {"before", "after", "both"}
            The mesh before the run, after the run, or both side by side in equal colors.
        measure : str
            Name of a measure; see `measures`.
        picture_range : (float, float), optional
            Values of the measure between which colors change, as `--picture-range` of the command line. Further values have
            the color of the nearer one. By default, colors change where good meshes differ, such as from 0.5 to 1 by shape.
        **options
            Options of `plot` for matplotlib.

        Raises
        ------
        ImportError
            matplotlib is not installed.
        OptionError
            No measure has the name, the measure has no such range, or quadrilaterals of the mesh do not have it.
        """
        _picture.show(self._subject(), which, measure, picture_range, options)

    def __getstate__(self) -> dict[str, Any]:
        outcome = self._outcome
        values: dict[str, Any] = {name: getattr(outcome, name) for name in _PROPERTIES}
        for name in _METHODS:
            values[name] = functools.partial(_same, getattr(outcome, name)())
        return {**self.__dict__, "_outcome": types.SimpleNamespace(**values)}

    def _subject(self) -> _picture.Subject:
        outcome = self._outcome
        states = {"before": outcome.flat_points_before(), "after": outcome.flat_points()}
        cells = outcome.chart_cells() or (self.triangles, self.quadrilaterals)
        return _picture.Subject(states, *cells, self.axes, outcome.surface)

    def _judged(self) -> tuple[str, float, float]:
        """Return the name of the objective that judges the run, and its values before and after the run."""
        if self.has_target:
            return "f of targets", float(self.history[0]), float(self.history[self.best_sweep])
        metric = self.metric
        return f"f {metric}", self.quality_before.f(metric), self.quality_after.f(metric)

    def _repr_html_(self) -> str:
        before, after = self.quality_before, self.quality_after
        name, f_before, f_after = self._judged()
        rows = [
            (name, f"{f_before:.6g}", f"{f_after:.6g}"),
            ("min angle", f"{before.min_angle:.2f}°", f"{after.min_angle:.2f}°"),
            ("max angle", f"{before.max_angle:.2f}°", f"{after.max_angle:.2f}°"),
            ("worst imr", f"{before.worst_imr:.6g}", f"{after.worst_imr:.6g}"),
            ("inverted", str(before.inverted), str(after.inverted)),
        ]
        return _picture.html(self._subject(), rows, f"{self.stop} after {self.sweeps} sweeps")

    def __repr__(self) -> str:
        name, before, after = self._judged()
        return (
            f"Result({self.stop} after {self.sweeps} sweeps on {self.engine}, "
            f"{name} {before:.6g} -> {after:.6g}, inverted {self.quality_after.inverted})"
        )
