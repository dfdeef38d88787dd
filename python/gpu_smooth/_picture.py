"""Pictures of meshes before and after a run: by matplotlib, and as SVG in notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from gpu_smooth import _native
from gpu_smooth._errors import OptionError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from gpu_smooth._options import Doubles, Integers, Surface

# Largest number of elements of which a notebook gets a picture. A picture of more takes megabytes.
MOST_ELEMENTS = 20_000
# Width of the picture of a mesh, in pixels.
WIDTH = 360.0


class Subject(NamedTuple):
    """Mesh of a picture, before and after a run."""

    states: dict[str, Doubles]
    """Points `"before"` and `"after"` the run, of shape (n, 2), in the plane in which they were moved.

    Longitudes are continued across the line where they jump, and vertices on cuts and at poles have copies.
    """
    triangles: Integers
    quadrilaterals: Integers
    axes: tuple[str, str]
    """Names of the two coordinates."""
    surface: Surface
    """Surface on which elements are measured."""


def plot(
    subject: Subject,
    which: str,
    measure: str,
    ax: Any,
    picture_range: tuple[float, float] | None,
    options: dict[str, Any],
) -> Any:
    """Draw a mesh by matplotlib; see `Result.plot`."""
    plt = _pyplot()
    from matplotlib.colors import LinearSegmentedColormap

    scale = _native.color_scale(measure, picture_range)
    states = subject.states
    if which not in ("before", "after", "both"):
        raise _which_error(which)
    names = list(states) if which == "both" else [which]
    # matplotlib makes room for all points, and some vertices may belong to no element.
    used, places = np.unique(
        np.concatenate([subject.triangles.ravel(), subject.quadrilaterals.ravel()]), return_inverse=True
    )
    of_triangles, of_others = np.split(places.ravel(), [subject.triangles.size])
    triangles, quadrilaterals = of_triangles.reshape(-1, 3), of_others.reshape(-1, 4)
    if ax is None:
        width, height = np.ptp(states["after"][used], axis=0)
        each = 6.0 * min(max(height / max(width, np.finfo(float).tiny), 0.3), 2.0)
        figure, axes = plt.subplots(
            1,
            len(names),
            squeeze=False,
            sharex=True,
            sharey=True,
            figsize=(6.0 * len(names) + 1.0, each + 0.6),
            layout="constrained",
        )
        all_axes = list(axes[0])
    else:
        figure, all_axes = ax.figure, [ax]
        names = names[-1:]
    values = {name: _judged_values(states[name], subject, measure) for name in names}
    colors = plt.get_cmap(options.get("cmap", LinearSegmentedColormap.from_list("quality", scale["colors"])))
    chosen: dict[str, Any] = {"edgecolors": "white", "linewidth": 0.2}
    # matplotlib refuses limits beside a norm, which has its own.
    if "norm" not in options:
        chosen |= {"vmin": scale["low"], "vmax": scale["high"]}
    # The color "bad" is that of values that are not numbers.
    chosen |= options | {"cmap": colors.with_extremes(bad=scale["inverted"])}
    drawn: Any = None
    for name, axis in zip(names, all_axes):
        points = states[name][used]
        if len(quadrilaterals):
            drawn = _add_polygons(axis, [*points[triangles], *points[quadrilaterals]], values[name], chosen)
        else:
            drawn = axis.tripcolor(points[:, 0], points[:, 1], triangles, facecolors=values[name], **chosen)
        axis.set_aspect("equal")
        axis.set_title(name)
        if subject.axes != ("x", "y"):
            axis.set(xlabel=subject.axes[0], ylabel=subject.axes[1])
    every = np.concatenate(list(values.values()))
    label = f"{measure.strip()} ({scale['unit']})" if scale["unit"] else measure.strip()
    if np.isnan(every).any():
        label += ", red: inverted or flat" + (" or concave" if len(quadrilaterals) else "")
    # The ends of the bar are pointed where values lie beyond.
    is_below, is_above = (every < drawn.norm.vmin).any(), (every > drawn.norm.vmax).any()
    extend = ("neither", "min", "max", "both")[is_below + 2 * is_above]
    figure.colorbar(drawn, ax=all_axes, label=label, extend=extend)
    return figure


def show(
    subject: Subject,
    which: str,
    measure: str,
    picture_range: tuple[float, float] | None,
    options: dict[str, Any],
) -> None:
    """Draw a mesh in a window, and wait until the window is closed; see `Result.show`."""
    plot(subject, which, measure, None, picture_range, options)
    _pyplot().show()


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as plt
    except ModuleNotFoundError as missing:
        text = "pictures are drawn by matplotlib, which is not installed: pip install matplotlib"
        raise ModuleNotFoundError(text, name=missing.name) from missing
    return plt


def _add_polygons(axis: Any, corners: list[Doubles], values: Doubles, chosen: dict[str, Any]) -> Any:
    """Draw polygons, each by its corners of shape (k, 2), as `tripcolor` draws triangles."""
    from matplotlib.collections import PolyCollection

    options = dict(chosen)
    low, high = options.pop("vmin", None), options.pop("vmax", None)
    drawn = PolyCollection(corners, array=values, **options)
    if low is not None or high is not None:
        drawn.set_clim(low, high)
    drawn.autoscale_None()
    axis.add_collection(drawn)
    axis.autoscale_view()
    return drawn


def _judged_values(flat: Doubles, subject: Subject, measure: str) -> Doubles:
    """Return the value of a measure for each triangle, then for each quadrilateral.

    A finite number, or NaN for an element that is inverted, flat or concave.
    """
    cells = (subject.triangles, subject.quadrilaterals)
    values: Doubles = np.minimum(_native.quality(flat, cells, measure, subject.surface, "data"), 1e300)
    if np.isnan(values[len(subject.triangles) :]).any():
        raise OptionError(f"measure: quadrilaterals have no {measure}. Choose another measure")
    values[_native.quality(flat, cells, "shape", subject.surface, "data") <= 0.0] = np.nan
    return values


def _which_error(which: str) -> Exception:
    return OptionError(f'which: the value is {which!r}, and must be "before" or "after" or "both"')


def html(subject: Subject, rows: Sequence[tuple[str, str, str]], ending: str) -> str:
    """Return a mesh before and after a run as HTML: pictures colored by shape, a table of three columns, and a sentence."""
    pictures = legend = ""
    if len(subject.triangles) + len(subject.quadrilaterals) <= MOST_ELEMENTS:
        pictures = "".join(
            f'<figure style="display:inline-block;margin:4px"><figcaption>{name}</figcaption>'
            f"{svg(points, subject)}</figure>"
            for name, points in subject.states.items()
        )
        legend = f"{_native.color_scale('shape', None)['legend']}.<br/>"
        if len(subject.quadrilaterals):
            legend = legend.replace("Triangles", "Triangles and quadrilaterals", 1)
    table = "".join(
        f"<tr><th>{name}</th><td>{was}</td><td>{now}</td></tr>" for name, was, now in rows
    )
    return (
        f"<div>{pictures}<table><tr><th></th><th>before</th><th>after</th></tr>{table}</table>"
        f"<p>{legend}{ending}</p></div>"
    )


def svg(flat: Doubles, subject: Subject) -> str:
    """Return a mesh with points of shape (n, 2) as an SVG picture, each element colored by its shape."""
    used = np.union1d(subject.triangles, subject.quadrilaterals)
    low, high = flat[used].min(axis=0), flat[used].max(axis=0)
    size = np.maximum(high - low, np.finfo(float).tiny)
    scale = WIDTH / max(size[0], size[1])
    xy = np.round((flat - low) * [scale, -scale] + [0.0, scale * size[1]], 2)
    chart = _native.color_scale("shape", None)
    quality = _judged_values(flat, subject, "shape")
    shares = (quality - chart["low"]) / (chart["high"] - chart["low"])
    steps = len(chart["colors"])
    # Inverted, flat and concave elements have the number after those of the steps.
    colors = np.nan_to_num(np.clip(np.floor(shares * steps), 0, steps - 1), nan=steps)
    of_triangles, of_others = np.split(colors, [len(subject.triangles)])
    paths = []
    for number, color in enumerate([*chart["colors"], chart["inverted"]]):
        corners = xy[subject.triangles[of_triangles == number]].reshape(-1, 6).tolist()
        path = "".join("M%g %gL%g %gL%g %gZ" % tuple(corner) for corner in corners)
        corners = xy[subject.quadrilaterals[of_others == number]].reshape(-1, 8).tolist()
        path += "".join("M%g %gL%g %gL%g %gL%g %gZ" % tuple(corner) for corner in corners)
        if path:
            paths.append(f'<path fill="{color}" d="{path}"/>')
    width, height = size * scale
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="-1 -1 {width + 2:.2f} {height + 2:.2f}" stroke="#fff" stroke-width="0.3" '
        f'stroke-linejoin="round">{"".join(paths)}</svg>'
    )
