"""Exceptions and warnings of the package."""

from __future__ import annotations

import sys
import warnings
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import FrameType


class GpuSmoothError(Exception):
    """Base of all exceptions of this package."""


class MeshError(GpuSmoothError, ValueError):
    """Arrays are no mesh that can be smoothed, or do not fit the mesh.

    Attributes
    ----------
    triangles : tuple of int
        Triangles that the message names, such as all inverted ones; numbered from 0.
    quadrilaterals : tuple of int
        Quadrilaterals that the message names; numbered from 0.
    vertex : int or None
        Vertex that the message names; numbered from 0.
    """

    triangles: tuple[int, ...] = ()
    quadrilaterals: tuple[int, ...] = ()
    vertex: int | None = None


class OptionError(GpuSmoothError, ValueError):
    """An option has a wrong value, or two options exclude each other."""


class DeviceError(GpuSmoothError, RuntimeError):
    """A GPU cannot be used, or has failed during a run."""


class FileError(GpuSmoothError, OSError):
    """A file cannot be read, written or converted."""


class MeshWarning(UserWarning):
    """A run will not do what the caller may expect of the mesh, or a checkpoint was not saved."""


def warn(text: str) -> None:
    """Issue a `MeshWarning` that names the line by which the package was called.

    Python shows a warning once for each line, so that a line of the package would hide the warnings of later calls.
    """
    level, frame = 1, sys._getframe().f_back
    while frame is not None and _is_of_package(frame):
        level, frame = level + 1, frame.f_back
    warnings.warn(text, MeshWarning, stacklevel=level + 1)


def _is_of_package(frame: FrameType) -> bool:
    name = str(frame.f_globals.get("__name__"))
    return name.partition(".")[0] == "gpu_smooth"
