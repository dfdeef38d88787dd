"""Stand-ins for meshes of MeshKernel and xugrid, with the attributes that gpu_smooth reads, for tests without these packages."""

from __future__ import annotations

import copy
import types
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass
class Mesh2d:
    """A `meshkernel.Mesh2d`."""

    node_x: Any
    node_y: Any
    edge_nodes: Any
    face_nodes: Any = field(default_factory=lambda: np.empty(0, np.int32))
    nodes_per_face: Any = field(default_factory=lambda: np.empty(0, np.int32))
    edge_x: Any = field(default_factory=lambda: np.empty(0))
    edge_y: Any = field(default_factory=lambda: np.empty(0))
    face_x: Any = field(default_factory=lambda: np.empty(0))
    face_y: Any = field(default_factory=lambda: np.empty(0))


class MeshKernel:
    """A `meshkernel.MeshKernel` that returns faces in reverse order, each begun at its second node, without the first.

    The centers of faces are the means of their nodes, moved by (100, 200).
    """

    def __init__(self, projection: str) -> None:
        self.projection = projection

    def mesh2d_set(self, mesh: Mesh2d) -> None:
        self.mesh = mesh

    def mesh2d_get(self) -> Mesh2d:
        found = copy.copy(self.mesh)
        faces = np.roll(found.face_nodes.reshape(-1, 3)[:0:-1], -1, axis=1)
        found.face_nodes, found.nodes_per_face = faces.ravel(), np.full(len(faces), 3)
        found.face_x, found.face_y = found.node_x[faces].mean(axis=1) + 100, found.node_y[faces].mean(axis=1) + 200
        return found


class Ugrid2d:
    """A `xugrid.Ugrid2d`. Its edges are the first two nodes of each face."""

    node_dimension = "mesh2d_nNodes"
    name = "mesh2d"

    def __init__(self, node_x: Any, node_y: Any, faces: Any, is_geographic: bool = False) -> None:
        self.node_x, self.node_y, self.face_node_connectivity = node_x, node_y, faces
        self.is_geographic = is_geographic
        self._attrs: dict[str, Any] = {}
        self._indexes: dict[str, str] = {}
        self._dataset: Any = "the file"
        self._kept: dict[str, Any] = {}

    def _clear_geometry_properties(self) -> None:
        self._kept = {}

    @property
    def node_coordinates(self) -> Any:
        return np.column_stack([self.node_x, self.node_y])

    @property
    def edge_coordinates(self) -> Any:
        return self.node_coordinates[self.face_node_connectivity[:, :2]].mean(axis=1)

    @property
    def centroids(self) -> Any:
        return self._kept.setdefault("centroids", self.node_coordinates[self.face_node_connectivity].mean(axis=1))

    @property
    def circumcenters(self) -> Any:
        return self.centroids + 1


class DataArray:
    """An `xarray.DataArray`."""

    def __init__(self, values: Any, *dims: str, coords: dict[str, DataArray] | None = None, name: str | None = None) -> None:
        self.values, self.dims, self.coords, self.name = np.asarray(values), dims, coords or {}, name
        self.dtype, self.size = self.values.dtype, self.values.size

    def get_axis_num(self, dim: str) -> int:
        return self.dims.index(dim)

    def to_numpy(self) -> Any:
        return self.values

    def copy(self, data: Any) -> DataArray:
        return DataArray(data, *self.dims, coords=self.coords)

    def assign_coords(self, coords: dict[str, DataArray]) -> DataArray:
        return DataArray(self.values, *self.dims, coords={**self.coords, **coords})


class Dataset:
    """An `xarray.Dataset`."""

    def __init__(self, data_vars: dict[str, DataArray], coords: dict[str, DataArray]) -> None:
        self.data_vars, self.coords = data_vars, coords

    def assign_coords(self, coords: dict[str, DataArray]) -> Dataset:
        return Dataset(self.data_vars, {**self.coords, **coords})

    def assign(self, data_vars: dict[str, DataArray]) -> Dataset:
        return Dataset({**self.data_vars, **data_vars}, self.coords)


class UgridDataArray:
    """A `xugrid.UgridDataArray`."""

    def __init__(self, obj: Any, grid: Any) -> None:
        self.obj, self.grids = obj, [grid]


class UgridDataset:
    """A `xugrid.UgridDataset`."""

    def __init__(self, obj: Any, grids: Any) -> None:
        self.obj, self.grids = obj, grids


def module(name: str, *classes: type, **others: Any) -> Any:
    """Return a module of some classes, which say that they are from the module."""
    made = types.ModuleType(name)
    for own in classes:
        own.__module__ = name
        setattr(made, own.__name__, own)
    for key, value in others.items():
        setattr(made, key, value)
    return made


PROJECTIONS = types.SimpleNamespace(CARTESIAN="plane", SPHERICAL="sphere")
meshkernel = module("meshkernel", Mesh2d, MeshKernel, ProjectionType=PROJECTIONS)
xugrid = module("xugrid", Ugrid2d, UgridDataArray, UgridDataset)
