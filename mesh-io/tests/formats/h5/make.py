"""Makes the files of this folder: one mesh in HDF5, as several programs write it.

Run it here with h5py, netCDF4, h5netcdf, meshio and gmsh installed (h5py 3.16 on HDF5 2.0, netCDF4 1.7, h5netcdf 1.8,
meshio 5.3 and gmsh 4.15 made what is in the repository). dolfinx is not needed: its layout is made by h5py.
"""

import math
import os
import shutil

import gmsh
import h5netcdf
import h5py
import meshio
import netCDF4
import numpy as np

COLUMNS, ROWS = 5, 4

points = np.array(
    [
        [
            i + (0.2 * math.sin(3 * i + 5 * j) if 0 < i < COLUMNS and 0 < j < ROWS else 0),
            j + (0.2 * math.cos(4 * i + 7 * j) if 0 < i < COLUMNS and 0 < j < ROWS else 0),
        ]
        for j in range(ROWS + 1)
        for i in range(COLUMNS + 1)
    ]
)
triangles = []
for j in range(ROWS):
    for i in range(COLUMNS):
        a = j * (COLUMNS + 1) + i
        b, c = a + 1, a + COLUMNS + 1
        triangles += [[a, b, c + 1], [a, c + 1, c]] if (i + j) % 2 else [[a, b, c], [b, c + 1, c]]
triangles = np.array(triangles)
line = np.array([[7, 8]])
# The last ten triangles are of another region.
region = np.array([5] * (len(triangles) - 10) + [2] * 10)
depth = points[:, 0] * 0.5 - points[:, 1]


def xdmf(name, geometry, topology, attributes=""):
    with open(name, "w") as out:
        out.write(
            '<?xml version="1.0"?>\n<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>\n'
            '<Xdmf Version="3.0" xmlns:xi="https://www.w3.org/2001/XInclude">\n  <Domain>\n'
            f'    <Grid Name="mesh" GridType="Uniform">\n{topology}{geometry}{attributes}'
            "    </Grid>\n  </Domain>\n</Xdmf>\n"
        )


def geometry(place, kind="XY", columns=2, more="", form="HDF"):
    return (
        f'      <Geometry GeometryType="{kind}">\n        <DataItem Dimensions="{len(points)} {columns}" '
        f'Format="{form}"{more}>{place}</DataItem>\n      </Geometry>\n'
    )


def topology(place, more="", form="HDF"):
    return (
        f'      <Topology TopologyType="Triangle" NumberOfElements="{len(triangles)}" NodesPerElement="3">\n'
        f'        <DataItem Dimensions="{len(triangles)} 3" NumberType="Int" Format="{form}"{more}>{place}</DataItem>\n'
        "      </Topology>\n"
    )


def attribute(name, center, place, dimensions, more="", form="HDF"):
    return (
        f'      <Attribute Name="{name}" AttributeType="Scalar" Center="{center}">\n'
        f'        <DataItem Dimensions="{dimensions}" Format="{form}"{more}>{place}</DataItem>\n      </Attribute>\n'
    )


# The mesh itself, with its numbers in the XML.
text = lambda rows: "\n".join(" ".join(repr(x.item()) for x in row) for row in rows)
xdmf(
    "plain.xdmf",
    geometry(text(points), form="XML", more=' Precision="8"'),
    topology(text(triangles), form="XML"),
)

def compact(group, name, data):
    p = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    p.set_layout(h5py.h5d.COMPACT)
    space = h5py.h5s.create_simple(data.shape)
    d = h5py.h5d.create(group.id, name, h5py.h5t.py_create(data.dtype), space, p)
    d.write(h5py.h5s.ALL, h5py.h5s.ALL, data)


# dolfin (FEniCS) and dolfinx: groups of the old style, datasets as they are.
with h5py.File("dolfin.h5", "w", libver=("earliest", "v108")) as f:
    f.create_dataset("Mesh/mesh/geometry", data=points)
    t = f.create_dataset("Mesh/mesh/topology", data=triangles.astype("u4"))
    t.attrs["celltype"] = np.bytes_("triangle")
    t.attrs["partition"] = np.array([0], dtype="u8")
    f.create_dataset("Function/T/0", data=depth.reshape(-1, 1))
    compact(f["Function"], b"c", depth)
xdmf(
    "dolfin.xdmf",
    geometry("dolfin.h5:/Mesh/mesh/geometry"),
    topology("dolfin.h5:/Mesh/mesh/topology"),
    attribute("T", "Node", "dolfin.h5:/Function/T/0", f"{len(points)} 1", ' Precision="8"')
    + attribute("c", "Node", "dolfin.h5:/Function/c", len(points), ' Precision="8"'),
)

# meshio: several kinds of cells, chunks compressed by gzip.
meshio.Mesh(
    np.c_[points, np.zeros(len(points))],
    [("triangle", triangles), ("line", line)],
    point_data={"T": depth, "n": np.arange(len(points))},
    cell_data={"region": [region, np.array([9])]},
).write("meshio.xdmf")

# The newest layouts, of chunks smaller than the datasets: fixed arrays with and without filters, one chunk, implicit.
with h5py.File("latest.h5", "w", libver="latest") as f:
    every = dict(compression="gzip", shuffle=True, fletcher32=True)
    g = f.create_group("Mesh", track_order=True)
    # Enough links for a group that has them in a fractal heap.
    for k in range(40):
        g.create_group(f"a group with a rather long name, number {k}")
    g.create_dataset("geometry", data=points.astype(">f8"), chunks=(7, 2), **every)
    g.create_dataset("topology", data=triangles.astype("i8"), chunks=(16, 2))
    g.create_dataset("T", data=depth.astype("f4"), chunks=(30,), compression="gzip")
    g.create_dataset("region", data=region.astype("i2"), chunks=(7,))
    g.create_dataset("u", data=depth.astype("f4"), chunks=(8,), shuffle=True, fletcher32=True)
    s = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    s.set_chunk((8,))
    s.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    d = h5py.h5d.create(
        g.id, b"implicit", h5py.h5t.IEEE_F32LE, h5py.h5s.create_simple((len(points),)), s
    )
    d.write(h5py.h5s.ALL, h5py.h5s.ALL, depth.astype("f4"))
    compact(g, b"c", depth)
    f["linked"] = h5py.SoftLink("/Mesh/geometry")
n, m = len(points), len(triangles)
xdmf(
    "latest.xdmf",
    geometry("latest.h5:/linked"),
    topology("latest.h5:/Mesh/topology"),
    attribute("T", "Node", "latest.h5:/Mesh/T", n)
    + attribute("u", "Node", "latest.h5:/Mesh/u", n)
    + attribute("c", "Node", "latest.h5:/Mesh/c", n)
    + attribute("w", "Node", "latest.h5:/Mesh/implicit", n)
    + attribute("region", "Cell", "latest.h5:/Mesh/region", m, ' NumberType="Int"'),
)

# Several chunks in the old index, single precision and three coordinates.
with h5py.File("chunked.h5", "w") as f:
    f.create_dataset(
        "xyz", data=np.c_[points, depth].astype("f4"), chunks=(8, 2), compression="gzip", shuffle=True
    )
    f.create_dataset("cells", data=triangles.astype("u8"), chunks=(4, 3), compression=9)
xdmf(
    "chunked.xdmf",
    geometry("chunked.h5:/xyz", "XYZ", 3),
    topology("chunked.h5:/cells"),
)

# Raw files, the points after a header and in the other order of bytes.
with open("raw.bin", "wb") as f:
    f.write(b"a header, ")
    f.write(points.astype(">f8").tobytes())
with open("raw-cells.bin", "wb") as f:
    f.write(triangles.astype("<i4").tobytes())
xdmf(
    "raw.xdmf",
    geometry("raw.bin", more=' Precision="8" Endian="Big" Seek="10"', form="Binary"),
    topology("raw-cells.bin", more=' Precision="4" Endian="Little"', form="Binary"),
)

# Two triangles with regions and data that are negative if their unsigned integers are read as signed ones.
with h5py.File("unsigned.h5", "w") as f:
    f.create_dataset("points", data=np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]]))
    f.create_dataset("cells", data=np.array([[0, 1, 2], [0, 2, 3]], dtype="u8"))
    f.create_dataset("region", data=np.array([4_000_000_000, 200], dtype="u4"))
    for kind, first in [("u1", 255), ("i1", -1), ("u8", 1 << 63)]:
        f.create_dataset(kind, data=np.array([first, 1], dtype=kind))
with open("unsigned.xdmf", "w") as out:
    out.write(
        '<Xdmf Version="3.0"><Domain><Grid Name="mesh"><Topology TopologyType="Triangle" NumberOfElements="2">\n'
        '<DataItem Dimensions="2 3" NumberType="UInt" Format="HDF">unsigned.h5:/cells</DataItem></Topology>\n'
        '<Geometry GeometryType="XY"><DataItem Dimensions="4 2" Precision="8" Format="HDF">unsigned.h5:/points</DataItem>'
        "</Geometry>\n"
    )
    for name, kind in [("region", "UInt"), ("u1", "UChar"), ("i1", "Char"), ("u8", "UInt")]:
        out.write(
            f'<Attribute Name="{name}" Center="Cell"><DataItem Dimensions="2" NumberType="{kind}" Format="HDF">'
            f"unsigned.h5:/{name}</DataItem></Attribute>\n"
        )
    out.write("</Grid></Domain></Xdmf>\n")


def exodus(name, form, zlib):
    with netCDF4.Dataset(name, "w", format=form) as f:
        options = dict(zlib=True, shuffle=True, fletcher32=True) if zlib else {}
        f.title = "a bay"
        f.setncattr("api_version", np.float32(8.03))
        f.setncattr("version", np.float32(8.03))
        f.setncattr("floating_point_word_size", np.int32(8))
        lengths = dict(
            len_name=16, time_step=None, num_dim=2, num_nodes=n, num_elem=m + 1, num_el_blk=3, num_el_in_blk1=m - 10,
            num_el_in_blk2=10, num_el_in_blk3=1, three=3, two=2, num_side_sets=1, num_side_ss1=2, num_nod_var=1, one=1,
        )
        for key, length in lengths.items():
            f.createDimension(key, length)
        v = lambda key, kind, dims: f.createVariable(key, kind, dims, **options)
        if not zlib:
            v = lambda key, kind, dims: f.createVariable(key, kind, dims)
        for axis, key in enumerate(["coordx", "coordy"]):
            v(key, "f8", ("num_nodes",))[:] = points[:, axis]
        v("eb_prop1", "i4", ("num_el_blk",))[:] = [5, 2, 9]
        names = v("eb_names", "S1", ("num_el_blk", "len_name"))
        names[:] = np.array([list(t.ljust(16, "\0")) for t in ["steel", "", "wire"]], dtype="S1")
        for block, kind, cells, corners in [
            (1, "TRI3", triangles[:-10], "three"),
            (2, "TRI3", triangles[-10:], "three"),
            (3, "BAR2", line, "two"),
        ]:
            c = v(f"connect{block}", "i4", (f"num_el_in_blk{block}", corners))
            c.elem_type = kind
            c[:] = cells + 1
        v("ss_prop1", "i4", ("num_side_sets",))[:] = [40]
        v("elem_ss1", "i4", ("num_side_ss1",))[:] = [1, 2]
        v("side_ss1", "i4", ("num_side_ss1",))[:] = [1, 1]
        v("time_whole", "f8", ("time_step",))[:] = [0.0, 1.0]
        names = v("name_nod_var", "S1", ("num_nod_var", "len_name"))
        names[:] = np.array([list("T".ljust(16, "\0"))], dtype="S1")
        data = v("vals_nod_var1", "f8", ("time_step", "num_nodes"))
        data[0] = depth
        data[1] = 2 * depth


exodus("classic.exo", "NETCDF3_CLASSIC", False)
exodus("netcdf4.exo", "NETCDF4", False)
exodus("zlib.exo", "NETCDF4", True)

# UGRID by netCDF, compressed, with time steps, edges and places of faces; and by h5netcdf, whose texts stand in a heap.
with netCDF4.Dataset("ugrid.nc", "w") as f:
    f.Conventions = "CF-1.8 UGRID-1.0"
    for key, length in dict(time=None, nNodes=n, nFaces=m, nMax=4).items():
        f.createDimension(key, length)
    mesh = f.createVariable("mesh", "i4", ())
    mesh.setncatts(
        dict(cf_role="mesh_topology", topology_dimension=np.int32(2), node_coordinates="mesh_node_x mesh_node_y",
             face_node_connectivity="mesh_face_nodes", face_dimension="nFaces", face_coordinates="mesh_face_x")
    )
    options = dict(zlib=True, shuffle=True)
    for axis, key in enumerate("xy"):
        f.createVariable(f"mesh_node_{key}", "f8", ("nNodes",), **options)[:] = points[:, axis]
    faces = f.createVariable("mesh_face_nodes", "i4", ("nFaces", "nMax"), fill_value=-999, **options)
    faces.start_index = np.int32(1)
    faces[:] = np.c_[triangles + 1, np.full(m, -999)]
    f.createVariable("mesh_face_x", "f8", ("nFaces",))[:] = points[triangles].mean(axis=1)[:, 0]
    data = f.createVariable("T", "f8", ("time", "nNodes"), **options)
    data.setncatts(dict(mesh="mesh", location="node", long_name="température"))
    data[0] = depth
    data[1] = 2 * depth

# The same coordinates under a filter that is not read.
with netCDF4.Dataset("zstd.nc", "w") as f:
    for key, length in dict(nNodes=n, nFaces=m, three=3).items():
        f.createDimension(key, length)
    mesh = f.createVariable("mesh", "i4", ())
    mesh.setncatts(
        dict(cf_role="mesh_topology", topology_dimension=np.int32(2), node_coordinates="x y", face_node_connectivity="faces")
    )
    for axis, key in enumerate("xy"):
        f.createVariable(key, "f8", ("nNodes",), compression="zstd")[:] = points[:, axis]
    f.createVariable("faces", "i4", ("nFaces", "three"))[:] = triangles

with h5netcdf.File("h5netcdf.nc", "w") as f:
    f.dimensions = dict(nNodes=n, nFaces=m, three=3)
    mesh = f.create_variable("mesh", (), "i4", data=0)
    mesh.attrs.update(
        cf_role="mesh_topology", topology_dimension=2, node_coordinates="mesh_node_x mesh_node_y",
        face_node_connectivity="mesh_face_nodes",
    )
    for axis, key in enumerate("yx"):
        f.create_variable(f"mesh_node_{key}", ("nNodes",), "f8", data=points[:, 1 - axis])
    f.create_variable("mesh_face_nodes", ("nFaces", "three"), "i8", data=triangles)
    f.create_variable("depth", ("nNodes",), "f8", data=depth).attrs.update(location="node", mesh="mesh")

# MED and CGNS by gmsh.
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.add("bay")
for tag, cells in [(5, triangles[:-10]), (2, triangles[-10:])]:
    gmsh.model.addDiscreteEntity(2, tag)
gmsh.model.addDiscreteEntity(1, 9)
gmsh.model.mesh.addNodes(2, 5, range(1, n + 1), np.c_[points, 0 * depth].flatten())
gmsh.model.mesh.addElementsByType(5, 2, range(1, m - 9), (triangles[:-10] + 1).flatten())
gmsh.model.mesh.addElementsByType(2, 2, range(m - 9, m + 1), (triangles[-10:] + 1).flatten())
gmsh.model.mesh.addElementsByType(9, 1, [m + 1], (line + 1).flatten())
gmsh.model.addPhysicalGroup(2, [5], 5, "steel")
gmsh.model.addPhysicalGroup(2, [2], 2, "sand")
gmsh.model.addPhysicalGroup(1, [9], 9, "wire")
gmsh.write("gmsh.med")
gmsh.write("gmsh.cgns")

# A square whose left and right sides are periodic. Connectivities of single corners are left out, as those of the sides
# contain the corners.
gmsh.clear()
gmsh.model.add("cell")
corners = [gmsh.model.geo.addPoint(x, y, 0, 0.34) for x, y in [(0, 0), (1, 0), (1, 1), (0, 1)]]
sides = [gmsh.model.geo.addLine(corners[i], corners[(i + 1) % 4]) for i in range(4)]
gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(sides)])
gmsh.model.geo.synchronize()
gmsh.model.mesh.setPeriodic(1, [sides[1]], [sides[3]], [1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
gmsh.model.addPhysicalGroup(2, [1], 1, "fluid")
gmsh.model.mesh.generate(2)
gmsh.write("all.cgns")
gmsh.finalize()
with h5py.File("all.cgns", "a") as whole, h5py.File("periodic.cgns", "w") as f:
    links = whole["all.cgns/cell_Part0/ZoneGridConnectivity"]
    for key in [key for key in links if "_0-P" in key]:
        del links[key]
    for key, value in whole.items():
        whole.copy(value, f, name=key)
os.remove("all.cgns")

# The mesh of periodic.cgns with two materials, as a solution at the centers of cells.
shutil.copyfile("periodic.cgns", "cells.cgns")
with h5py.File("cells.cgns", "a") as f:
    def node(parent, name, label, kind, data=None):
        own = parent.create_group(name)
        for key, text, size in (("name", name, 33), ("label", label, 33), ("type", kind, 3)):
            own.attrs.create(key, text.encode(), dtype=f"S{size}")
        own.attrs.create("flags", [1], dtype="i4")
        if data is not None:
            own.create_dataset(" data", data=data)
        return own

    zone = f["all.cgns/cell_Part0"]
    corners = zone["3_S_1/ElementConnectivity/ data"][:].reshape(-1, 3) - 1
    left = zone["GridCoordinates/CoordinateX/ data"][:][corners].mean(axis=1) < 0.5
    solution = node(zone, "Materials", "FlowSolution_t", "MT")
    node(solution, "GridLocation", "GridLocation_t", "C1", np.frombuffer(b"CellCenter", dtype="i1"))
    node(solution, "Material", "DataArray_t", "R8", np.where(left, 1.0, 2.0))
    node(solution, "Part", "DataArray_t", "I4", np.where(left, 3, 4).astype("i4"))
