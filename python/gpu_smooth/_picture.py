"""Pictures of results: by matplotlib, and as SVG in notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gpu_smooth import _native

if TYPE_CHECKING:
    from gpu_smooth._options import Doubles, Integers
    from gpu_smooth._result import Result

# Largest number of triangles of which a notebook gets a picture. A picture of more takes megabytes.
MOST_TRIANGLES = 20_000
# Width of the picture of a mesh, in pixels.
WIDTH = 360.0


def plot(
    result: Result,
    which: str,
    measure: str,
    ax: Any,
    picture_range: tuple[float, float] | None,
    options: dict[str, Any],
) -> Any:
    """Draw a result by matplotlib; see `Result.plot`."""
    plt = _pyplot()
    from matplotlib.colors import LinearSegmentedColormap

    scale = _native.color_scale(measure, picture_range)
    states = flat_states(result)
    if which not in ("before", "after", "both"):
        raise _which_error(which)
    names = list(states) if which == "both" else [which]
    # matplotlib makes room for all points, and some vertices may belong to no triangle.
    used, triangles = np.unique(result.triangles, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
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
    values = {name: _judged_values(states[name], result.triangles, measure) for name in names}
    row = next(row for row in _native.measures() if row["name"] == measure.lower().replace("_", "-"))
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
        drawn = axis.tripcolor(
            points[:, 0], points[:, 1], triangles, facecolors=values[name], **chosen
        )
        axis.set_aspect("equal")
        axis.set_title(name)
        if result.axes != ("x", "y"):
            axis.set(xlabel=result.axes[0], ylabel=result.axes[1])
    every = np.concatenate(list(values.values()))
    label = f"{measure} ({row['unit']})" if row["unit"] else measure
    if np.isnan(every).any():
        label += ", red: inverted or flat"
    # The ends of the bar are pointed where values lie beyond.
    is_below, is_above = (every < drawn.norm.vmin).any(), (every > drawn.norm.vmax).any()
    extend = ("neither", "min", "max", "both")[is_below + 2 * is_above]
    figure.colorbar(drawn, ax=all_axes, label=label, extend=extend)
    return figure


def flat_states(result: Result) -> dict[str, Doubles]:
    """Return the points before and after the run, of shape (n, 2), in the plane in which they were moved."""
    outcome = result._outcome
    return {"before": outcome.flat_points_before(), "after": outcome.flat_points()}


def show(
    result: Result,
    which: str,
    measure: str,
    picture_range: tuple[float, float] | None,
    options: dict[str, Any],
) -> None:
    """Draw a result in a window, and wait until the window is closed; see `Result.show`."""
    plot(result, which, measure, None, picture_range, options)
    _pyplot().show()


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as plt
    except ModuleNotFoundError as missing:
        text = "pictures are drawn by matplotlib, which is not installed: pip install matplotlib"
        raise ModuleNotFoundError(text, name=missing.name) from missing
    return plt


def _judged_values(flat: Doubles, triangles: Integers, measure: str) -> Doubles:
    """Return the value of a measure for each triangle: a finite number, or NaN for an inverted or flat triangle."""
    values: Doubles = np.minimum(_native.quality(flat, triangles, measure, "plane", "data"), 1e300)
    values[_native.quality(flat, triangles, "shape", "plane", "data") <= 0.0] = np.nan
    return values


def _which_error(which: str) -> Exception:
    from gpu_smooth._errors import OptionError

    return OptionError(f'which: the value is {which!r}, and must be "before" or "after" or "both"')


def judged(result: Result) -> tuple[str, float, float]:
    """Return the name of the objective that judges a run, and its values before and after the run."""
    if result.has_target:
        return "f of targets", float(result.history[0]), float(result.history[result.best_sweep])
    metric = result.metric
    return f"f {metric}", result.quality_before.f(metric), result.quality_after.f(metric)


def html(result: Result) -> str:
    """Return a result as HTML: the mesh before and after the run, colored by shape, and a table."""
    pictures = legend = ""
    if len(result.triangles) <= MOST_TRIANGLES:
        pictures = "".join(
            f'<figure style="display:inline-block;margin:4px"><figcaption>{name}</figcaption>'
            f"{svg(points, result.triangles)}</figure>"
            for name, points in flat_states(result).items()
        )
        legend = f"{_native.color_scale('shape', None)['legend']}.<br/>"
    before, after = result.quality_before, result.quality_after
    name, f_before, f_after = judged(result)
    rows = [
        (name, f"{f_before:.6g}", f"{f_after:.6g}"),
        ("min angle", f"{before.min_angle:.2f}°", f"{after.min_angle:.2f}°"),
        ("max angle", f"{before.max_angle:.2f}°", f"{after.max_angle:.2f}°"),
        ("worst imr", f"{before.worst_imr:.6g}", f"{after.worst_imr:.6g}"),
        ("inverted", str(before.inverted), str(after.inverted)),
    ]
    table = "".join(
        f"<tr><th>{name}</th><td>{was}</td><td>{now}</td></tr>" for name, was, now in rows
    )
    return (
        f"<div>{pictures}<table><tr><th></th><th>before</th><th>after</th></tr>{table}</table>"
        f"<p>{legend}{result.stop} after {result.sweeps} sweeps</p></div>"
    )


def svg(flat: Doubles, triangles: Integers) -> str:
    """Return a mesh with points of shape (n, 2) as an SVG picture, each triangle colored by its shape."""
    used = np.unique(triangles)
    low, high = flat[used].min(axis=0), flat[used].max(axis=0)
    size = np.maximum(high - low, np.finfo(float).tiny)
    scale = WIDTH / max(size[0], size[1])
    xy = np.round((flat - low) * [scale, -scale] + [0.0, scale * size[1]], 2)
    chart = _native.color_scale("shape", None)
    quality = _judged_values(flat, triangles, "shape")
    shares = (quality - chart["low"]) / (chart["high"] - chart["low"])
    steps = len(chart["colors"])
    # Inverted and flat triangles have the number after those of the steps.
    colors = np.nan_to_num(np.clip(np.floor(shares * steps), 0, steps - 1), nan=steps)
    paths = []
    for number, color in enumerate([*chart["colors"], chart["inverted"]]):
        corners = xy[triangles[colors == number]].reshape(-1, 6).tolist()
        path = "".join("M%g %gL%g %gL%g %gZ" % tuple(corner) for corner in corners)
        if path:
            paths.append(f'<path fill="{color}" d="{path}"/>')
    width, height = size * scale
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}" '
        f'viewBox="-1 -1 {width + 2:.2f} {height + 2:.2f}" stroke="#fff" stroke-width="0.3" '
        f'stroke-linejoin="round">{"".join(paths)}</svg>'
    )
