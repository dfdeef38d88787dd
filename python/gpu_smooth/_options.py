"""Options by the names of the command line, as types.

`MeshOptions` belong to a mesh and `RunOptions` to a run. `None` is the default of each option.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict, Union

import numpy as np
import numpy.typing as npt

from gpu_smooth._progress import Progress

if TYPE_CHECKING:
    from os import PathLike

Array: TypeAlias = "npt.ArrayLike"
Floats: TypeAlias = "npt.NDArray[np.floating[Any]]"
Doubles: TypeAlias = "npt.NDArray[np.float64]"
Integers: TypeAlias = "npt.NDArray[np.int64]"
Path: TypeAlias = "Union[str, bytes, PathLike[str], PathLike[bytes]]"

Surface: TypeAlias = Literal["plane", "sphere"]
ThirdCoordinate: TypeAlias = Literal["coordinate", "data"]
Target: TypeAlias = Union[
    Literal["equilateral", "keep-size", "keep-shape", "keep_size", "keep_shape"],
    "npt.ArrayLike",
    "tuple[npt.ArrayLike, npt.ArrayLike, npt.ArrayLike]",
]


class MeshOptions(TypedDict, total=False):
    """Options that belong to a mesh; `smooth` describes each."""

    quadrilaterals: Array | Literal["keep", "move"] | None
    fixed: Array | None
    lines: Array | None
    regions: Array | None
    slide: bool | None
    corner_angle: float | None
    hausdorff: float | None
    periodic: Array | None
    keep_layers: str | tuple[str, Array] | None
    free_lines: bool | None
    only_bad: float | None
    rings: int | None
    target: Target | None
    target_rings: int | None
    target_of: Literal["vertex", "place"] | None
    surface: Literal["plane", "sphere"] | None
    z: Literal["coordinate", "data"] | None
    untangle: bool | None


class RunOptions(TypedDict, total=False):
    """Options of a run; `smooth` describes each."""

    scheme: str | Sequence[str] | None
    engine: Literal["auto", "gpu", "cpu"] | None
    adapter: str | None
    max_sweeps: int | None
    tolerance: float | None
    fraction: float | None
    desired: float | Literal["auto"] | None
    time_limit: float | None
    method: Literal["auto", "multilevel", "relaxed", "paper"] | None
    omega: float | None
    inner: int | None
    derivatives: Literal["analytic", "finite-difference"] | None
    edge_norm: Literal["fixed", "continued"] | None
    guard: Literal["by-metric", "worst"] | None
    improve_worst: bool | Literal["imr", "min-angle", "altitude"] | None
    max_move: float | None
    keep_altitude: bool | None
    history: Literal["base", "all"] | None
    on_sweep: Callable[[Progress], object] | None
    checkpoint: Path | None
    checkpoint_every: float | None
    resume: Path | None


class SmoothOptions(MeshOptions, RunOptions, total=False):
    """All options of `smooth` and `run`."""
