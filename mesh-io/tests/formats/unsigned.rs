//! Unsigned integers in binary: data and regions whose highest bit is set are not negative.

use super::Folder;
use super::hdf5::made;
use super::made::netcdf::{Attribute, NetCdf};
use mesh_io::{Content, MeshFile, Precision};
use std::fs;

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Returns the values of an array of cell data.
fn cells<'c>(content: &'c Content, name: &str) -> &'c [f64] {
    content.cell_data().iter().find(|data| data.name() == name).unwrap().values()
}

/// Returns the tags of all groups.
fn tags(file: &MeshFile) -> Vec<i64> {
    file.groups().unwrap().iter().filter_map(|group| group.tag).collect()
}

/// Types of netCDF: 1 is BYTE, 7 UBYTE, 8 USHORT, 9 UINT and 11 UINT64.
#[test]
fn unsigned_integers_of_netcdf_are_not_negative() {
    let mut file = NetCdf::new(5);
    file.ints("mesh", &[], &[0]);
    file.attribute("cf_role", Attribute::Text("mesh_topology"));
    file.attribute("topology_dimension", Attribute::Whole(2));
    file.attribute("node_coordinates", Attribute::Text("x y"));
    file.attribute("face_node_connectivity", Attribute::Text("faces"));
    file.attribute("face_dimension", Attribute::Text("face"));
    // The third face is a quadrilateral, so that triangles lack a corner. No attribute names the fill value.
    let faces: [u32; 12] = [0, 1, 4, u32::MAX, 1, 2, 4, u32::MAX, 2, 3, 0, 4];
    let bytes = |numbers: &[u64], width: usize| -> Vec<u8> {
        numbers.iter().flat_map(|number| number.to_be_bytes()[8 - width..].to_vec()).collect()
    };
    file.add("faces", 9, &["face", "corner"], bytes(&faces.map(u64::from), 4));
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        let points = SQUARE.iter().chain(&[[0.5, 0.5]]).map(|point| point[axis]);
        file.reals(name, Precision::Double, &["node"], &points.collect::<Vec<_>>());
    }
    let arrays: [(&str, i32, usize, [u64; 3]); 5] = [
        ("byte", 1, 1, [200, 1, 2]),
        ("ubyte", 7, 1, [200, 1, 2]),
        ("ushort", 8, 2, [65_535, 1, 2]),
        ("uint", 9, 4, [3_000_000_000, 1, 2]),
        ("uint64", 11, 8, [1 << 63, 1, 2]),
    ];
    for (name, number, width, values) in arrays {
        file.add(name, number, &["face"], bytes(&values, width));
        file.attribute("location", Attribute::Text("face"));
    }
    let folder = Folder::new(&[]);
    folder.put("a.nc", file.build(&[("node", 5), ("face", 3), ("corner", 4)], 0).bytes);
    let read = folder.read("a.nc");
    assert_eq!((read.triangles().len(), read.quadrilaterals().len()), (2, 1));
    let content = read.content().unwrap();
    for (name, first) in [
        ("byte", -56.0),
        ("ubyte", 200.0),
        ("ushort", 65_535.0),
        ("uint", 3e9),
        ("uint64", 9_223_372_036_854_775_808.0),
    ] {
        assert_eq!(cells(&content, name), [first, 1.0, 2.0], "{name}");
    }
}

#[test]
fn unsigned_integers_of_hdf5_are_not_negative() {
    let folder = Folder::new(&[]);
    for name in ["unsigned.xdmf", "unsigned.h5"] {
        fs::copy(made(name), folder.path(name)).unwrap();
    }
    let read = folder.read("unsigned.xdmf");
    assert_eq!(tags(&read), [200, 4_000_000_000]);
    let content = read.content().unwrap();
    assert_eq!(cells(&content, "u1"), [255.0, 1.0]);
    assert_eq!(cells(&content, "i1"), [-1.0, 1.0]);
    assert_eq!(cells(&content, "u8"), [9_223_372_036_854_775_808.0, 1.0]);
}

#[test]
fn unsigned_integers_of_raw_files_are_not_negative() {
    let array = |name: &str, kind: &str, seek: u64, width: u64| {
        format!(
            "<Attribute Name=\"{name}\" Center=\"Cell\"><DataItem Dimensions=\"2\" NumberType=\"{kind}\" \
             Precision=\"{width}\" Format=\"Binary\" Endian=\"Big\" Seek=\"{seek}\">a.bin</DataItem></Attribute>"
        )
    };
    let text = format!(
        "<Xdmf Version=\"3.0\"><Domain><Grid Name=\"mesh\"><Topology TopologyType=\"Triangle\" NumberOfElements=\"2\">\
         <DataItem Dimensions=\"2 3\" NumberType=\"Int\">0 1 2 0 2 3</DataItem></Topology>\
         <Geometry GeometryType=\"XY\"><DataItem Dimensions=\"4 2\">0 0 1 0 1 1 0 1</DataItem></Geometry>{}{}{}\
         </Grid></Domain></Xdmf>",
        array("region", "UInt", 0, 4),
        array("uchar", "UChar", 8, 1),
        array("char", "Char", 8, 1)
    );
    let folder = Folder::new(&[("a.xdmf", &text)]);
    folder.put("a.bin", [0xEE, 0x6B, 0x28, 0, 0, 0, 0, 200, 255, 1]);
    let read = folder.read("a.xdmf");
    assert_eq!(tags(&read), [200, 4_000_000_000]);
    let content = read.content().unwrap();
    assert_eq!(cells(&content, "uchar"), [255.0, 1.0]);
    assert_eq!(cells(&content, "char"), [-1.0, 1.0]);
}
