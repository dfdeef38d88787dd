"""Moves the interior vertices of 2D meshes so that their triangles and quadrilaterals get better shapes.

>>> import gpu_smooth
>>> points = [[0, 0], [2, 0], [2, 2], [0, 2], [1.5, 1.2]]
>>> triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
>>> gpu_smooth.smooth(points, triangles)[4].round(3).tolist()
[1.0, 1.0]

`smooth` returns points, and `run` a report too. `Smoother` prepares a mesh for several runs. `quality`, `untangle`,
`interpolate` and `compare` work on arrays; `MeshFile`, `smooth_file` and `convert` on files.
"""

from gpu_smooth._arrays import (
    Adapter,
    Comparison,
    Measure,
    Metric,
    Spread,
    adapters,
    compare,
    interpolate,
    measures,
    metrics,
    quality,
    untangle,
)
from gpu_smooth._errors import (
    DeviceError,
    FileError,
    GpuSmoothError,
    MeshError,
    MeshWarning,
    OptionError,
)
from gpu_smooth._files import Group, MeshFile, convert, smooth_file
from gpu_smooth._gmsh import smooth_gmsh_model
from gpu_smooth._native import Quality, __version__
from gpu_smooth._progress import Progress
from gpu_smooth._result import Result
from gpu_smooth._smooth import Smoother, run, smooth

__all__ = [
    "Adapter",
    "Comparison",
    "DeviceError",
    "FileError",
    "GpuSmoothError",
    "Group",
    "Measure",
    "MeshError",
    "MeshFile",
    "MeshWarning",
    "Metric",
    "OptionError",
    "Progress",
    "Quality",
    "Result",
    "Smoother",
    "Spread",
    "__version__",
    "adapters",
    "compare",
    "convert",
    "interpolate",
    "measures",
    "metrics",
    "quality",
    "run",
    "smooth",
    "smooth_file",
    "smooth_gmsh_model",
    "untangle",
]
