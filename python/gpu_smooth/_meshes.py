"""Meshes of other packages in place of arrays."""

from __future__ import annotations

import os
from typing import Any


def smooth(mesh: Any, options: dict[str, Any]) -> Any:
    """Smooth a mesh of meshio or PyVista, and return a mesh of the same kind."""
    if isinstance(mesh, (str, os.PathLike)):
        raise TypeError(
            "points and triangles are needed, not the name of a file. gpu_smooth.MeshFile reads a file, and "
            "gpu_smooth.smooth_file smooths one"
        )
    # The package of a mesh is imported already, so that no package is imported for a wrong argument.
    module = type(mesh).__module__.partition(".")[0]
    if module == "meshio":
        from gpu_smooth import _meshio

        return _meshio.smooth(mesh, options)
    if any(kind.__module__.partition(".")[0] == "pyvista" for kind in type(mesh).__mro__):
        from gpu_smooth import _pyvista

        return _pyvista.smooth(mesh, options)
    raise TypeError(
        "points and triangles are needed, or a mesh of meshio or PyVista, not an object of type "
        f"{type(mesh).__name__}"
    )
