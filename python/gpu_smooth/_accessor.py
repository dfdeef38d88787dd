"""The accessor `gpu_smooth` of PyVista's datasets, which PyVista 0.48 and later find by an entry point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pyvista

from gpu_smooth._arrays import quality
from gpu_smooth._meshes import smooth

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from gpu_smooth._options import Doubles, SmoothOptions, Surface, ThirdCoordinate


class Accessor:
    """Smoothing as `mesh.gpu_smooth`, for `pyvista.UnstructuredGrid` and `pyvista.PolyData`."""

    def __init__(self, mesh: Any) -> None:
        self._mesh = mesh

    def smooth(self, **options: Unpack[SmoothOptions]) -> Any:
        """Return a copy of the mesh with moved vertices; see `gpu_smooth.smooth` for the options and exceptions."""
        return smooth(self._mesh, dict(options))

    def quality(
        self, measure: str = "imr", *, surface: Surface = "plane", z: ThirdCoordinate = "coordinate"
    ) -> Doubles:
        """Return the quality of each triangle and quadrilateral, of shape (m + k,); see `gpu_smooth.quality`."""
        return quality(self._mesh, measure=measure, surface=surface, z=z)


pyvista.register_dataset_accessor("gpu_smooth", pyvista.UnstructuredGrid)(Accessor)
pyvista.register_dataset_accessor("gpu_smooth", pyvista.PolyData)(Accessor)
