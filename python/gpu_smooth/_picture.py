"""Pictures of results: by matplotlib, and as SVG in notebooks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from gpu_smooth import _native

if TYPE_CHECKING:
    from gpu_smooth._options import Doubles, Integers
    from gpu_smooth._result import Result

# Colors of shapes from good to bad: matplotlib's viridis_r at equal steps.
COLORS = ("#fde725", "#a0da39", "#4ac16d", "#1fa187", "#277f8e", "#365c8d", "#46327e", "#440154")
# Largest inverse mean ratio that has a color of its own; worse triangles have the last color.
WORST = 3.0
# Largest number of triangles of which a notebook gets a picture. A picture of more takes megabytes.
MOST_TRIANGLES = 20_000
# Width of the picture of a mesh, in pixels.
WIDTH = 360.0


def plot(result: Result, which: str, measure: str, ax: Any, options: dict[str, Any]) -> Any:
    """Draw a result by matplotlib; see `Result.plot`."""
    plt = _pyplot()
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
    values = {
        name: _native.quality(states[name], result.triangles, measure, "plane", "data") for name in names
    }
    finite = np.concatenate([value[np.isfinite(value)] for value in values.values()])
    row = next(row for row in _native.measures() if row["name"] == measure.lower().replace("_", "-"))
    # Bad triangles are dark by every measure. A few very bad triangles would take all colors.
    is_low_good = row["better"] == "lower"
    colors, low, high = ("viridis_r", 0.0, 0.99) if is_low_good else ("viridis", 0.01, 1.0)
    chosen: dict[str, Any] = {"edgecolors": "white", "linewidth": 0.2, "cmap": colors}
    # matplotlib refuses limits beside a norm, which has its own.
    if finite.size and "norm" not in options:
        chosen |= {"vmin": np.quantile(finite, low), "vmax": np.quantile(finite, high)}
    chosen |= options
    drawn = None
    for name, axis in zip(names, all_axes):
        points = states[name][used]
        drawn = axis.tripcolor(
            points[:, 0], points[:, 1], triangles, facecolors=_finite(values[name]), **chosen
        )
        axis.set_aspect("equal")
        axis.set_title(name)
        if result.axes != ("x", "y"):
            axis.set(xlabel=result.axes[0], ylabel=result.axes[1])
    figure.colorbar(drawn, ax=all_axes, label=f"{measure} ({row['unit']})" if row["unit"] else measure)
    return figure


def flat_states(result: Result) -> dict[str, Doubles]:
    """Return the points before and after the run, of shape (n, 2), in the plane in which they were moved."""
    outcome = result._outcome
    return {"before": outcome.flat_points_before(), "after": outcome.flat_points()}


def show(result: Result, which: str, measure: str, options: dict[str, Any]) -> None:
    """Draw a result in a window, and wait until the window is closed; see `Result.show`."""
    plot(result, which, measure, None, options)
    _pyplot().show()


def _pyplot() -> Any:
    try:
        import matplotlib.pyplot as plt
    except ModuleNotFoundError as missing:
        text = "pictures are drawn by matplotlib, which is not installed: pip install matplotlib"
        raise ModuleNotFoundError(text, name=missing.name) from missing
    return plt


def _finite(values: Doubles) -> Doubles:
    largest = np.max(values[np.isfinite(values)], initial=0.0)
    finite: Doubles = np.where(np.isfinite(values), values, largest)
    return finite


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
    pictures = ""
    if len(result.triangles) <= MOST_TRIANGLES:
        pictures = "".join(
            f'<figure style="display:inline-block;margin:4px"><figcaption>{name}</figcaption>'
            f"{svg(points, result.triangles)}</figure>"
            for name, points in flat_states(result).items()
        )
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
        f"<p>{result.stop} after {result.sweeps} sweeps</p></div>"
    )


def svg(flat: Doubles, triangles: Integers) -> str:
    """Return a mesh with points of shape (n, 2) as an SVG picture, each triangle colored by its inverse mean ratio."""
    used = np.unique(triangles)
    low, high = flat[used].min(axis=0), flat[used].max(axis=0)
    size = np.maximum(high - low, np.finfo(float).tiny)
    scale = WIDTH / max(size[0], size[1])
    xy = np.round((flat - low) * [scale, -scale] + [0.0, scale * size[1]], 2)
    quality = _native.quality(flat, triangles, "imr", "plane", "data")
    shares = np.nan_to_num((quality - 1.0) / (WORST - 1.0), nan=1.0, posinf=1.0)
    colors = np.clip(shares * len(COLORS), 0, len(COLORS) - 1).astype(int)
    paths = []
    for number, color in enumerate(COLORS):
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
