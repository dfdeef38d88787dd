//! UGRID: data of nodes, arrays that a rewrite keeps, and refused files.

use super::Folder;
use super::facts::remarks;
use super::hdf5;
use super::made::netcdf::{Attribute, NetCdf};
use super::made::{Made, all, base};
use super::others::folder;
use mesh_io::{Format, MeshFile, Precision, Remark};
use std::fs;

/// Returns the samples with faces.
fn samples() -> Vec<Made> {
    let mut all = all(&base());
    all.retain(|made| made.format == Format::Ugrid && !made.lists_edges());
    all
}

#[test]
fn variables_of_nodes_are_data_in_every_time_step_and_layer() {
    for made in samples() {
        let file = folder(&made, &made.bytes).read(made.name);
        assert_eq!(file.data_names(), ["lon", "bay_node_z", "u", "level"]);
        let fields = file.point_fields(None).unwrap();
        let told: Vec<_> = fields.iter().map(|field| (field.name(), field.components())).collect();
        assert_eq!(told, [("lon", 1), ("bay_node_z", 1), ("u", 2), ("level", 1), ("level", 1)]);
        assert_eq!(fields[2].values()[9], 1.125);
        assert_eq!(fields[4].values()[7], 14.0);
        // A missing depth is read as NaN, so that no mean of depths includes the fill value.
        let depths = fields[1].values();
        assert!(depths[3].is_nan() && depths[4] == -2.0);
    }
}

#[test]
fn a_missing_number_stays_where_others_are_replaced() {
    for made in samples() {
        let folder = folder(&made, &made.bytes);
        let file = folder.read(made.name);
        let mut fields = file.point_fields(Some(&["bay_node_z".to_owned()])).unwrap();
        let values = fields[0].values().iter().map(|x| x * 3.0).collect();
        assert_eq!(fields[0].set(values).unwrap(), 0);
        file.write_with_fields(&folder.path("out.nc"), file.points(), &fields).unwrap();
        let again = folder.read("out.nc").point_fields(Some(&["bay_node_z".to_owned()])).unwrap();
        assert!(again[0].values()[3].is_nan());
        assert_eq!(again[0].values()[4], -6.0);
        let changed = fs::read(folder.path("out.nc")).unwrap();
        let differ = changed.iter().zip(&made.bytes).filter(|(a, b)| a != b).count();
        assert!(changed.len() == made.bytes.len() && differ < 8 * 29, "{differ} bytes differ");
    }
}

#[test]
fn centers_of_faces_follow_the_vertices() {
    for made in samples() {
        let folder = folder(&made, &made.bytes);
        let file = folder.read(made.name);
        assert!(file.has_centers() && remarks(&file).iter().all(|note| !note.contains("face_")));
        let to = hdf5::moved(&file, 0.0);
        let (mut fields, others) = file.centers(&to).unwrap();
        let names: Vec<_> = fields.iter().map(|field| field.name()).collect();
        assert_eq!((&names[..], &others[..]), (&["face_x"][..], &["face_y".to_owned()][..]));
        file.write_with_fields(&folder.path("out.nc"), &to, &fields).unwrap();
        let again = folder.read("out.nc");
        let (theirs, _) = again.centers(&to).unwrap();
        assert_eq!(theirs[0].values(), fields[0].values());
        assert!(file.difference(&again).is_some());
        assert_eq!(file.difference_ignoring(&again, [&fields, &theirs]), None);
        // The last triangle of the mesh is the last face of the file.
        let corners = again.triangles().last().unwrap();
        let x = |&v: &u32| to[v as usize][0];
        let mean = corners.iter().map(x).sum::<f64>() / 3.0;
        assert!((fields[0].values().last().unwrap() - mean).abs() < 1e-6);
        // If no vertex has moved, no bit of the file changes.
        fields = file.centers(file.points()).unwrap().0;
        file.write_with_fields(&folder.path("out.nc"), file.points(), &fields).unwrap();
        assert!(fs::read(folder.path("out.nc")).unwrap() == made.bytes);
    }
}

/// Returns the mean of the corners of each triangle, on the sphere, with longitudes from -180 to 180.
fn centers_on_sphere(points: &[[f64; 2]], triangles: &[[u32; 3]]) -> Vec<[f64; 2]> {
    let center = |triangle: &[u32; 3]| {
        let mut sum = [0.0; 3];
        for &v in triangle {
            let [x, y] = points[v as usize].map(f64::to_radians);
            let at = [y.cos() * x.cos(), y.cos() * x.sin(), y.sin()];
            (0..3).for_each(|k| sum[k] += at[k]);
        }
        let [x, y, z] = sum;
        [y.atan2(x).to_degrees(), (z / (x * x + y * y + z * z).sqrt()).asin().to_degrees()]
    };
    triangles.iter().map(center).collect()
}

#[test]
fn centers_in_degrees_follow_the_vertices_across_the_date_line() {
    let wrap = |[x, y]: [f64; 2]| [(x + 180.0).rem_euclid(360.0) - 180.0, y];
    let mut mesh = base();
    let place = |[x, y]: [f64; 2]| wrap([178.1 + x, 50.0 + y]);
    mesh.points.iter_mut().for_each(|point| *point = place(*point));
    let triangles = mesh.triangles.clone();
    let flat = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let lifted = |v: u32| {
            let [x, y] = points[v as usize];
            [x.rem_euclid(360.0), y]
        };
        let mean = |t: &[u32; 3]| {
            let corners = t.map(lifted);
            [0, 1].map(|k| (corners[0][k] + corners[1][k] + corners[2][k]) / 3.0)
        };
        triangles.iter().map(|t| wrap(mean(t))).collect()
    };
    let on_sphere = |points: &[[f64; 2]]| centers_on_sphere(points, &triangles);
    type Centers<'a> = &'a dyn Fn(&[[f64; 2]]) -> Vec<[f64; 2]>;
    for (centers, attributes) in [
        (&flat as Centers<'_>, ["standard_name", "longitude", "latitude"]),
        (&on_sphere, ["units", "degrees_east", "degrees_north"]),
    ] {
        let bytes = super::made::ugrid::in_degrees(&mesh, &centers(&mesh.points), attributes);
        let folder = Folder::new(&[]);
        fs::write(folder.path("in.nc"), &bytes).unwrap();
        let file = folder.read("in.nc");
        assert_eq!(file.remarks(), [Remark::Degrees]);
        let to: Vec<_> = file.points().iter().map(|&[x, y]| wrap([x + 0.05, y + 0.01])).collect();
        let (fields, others) = file.centers(&to).unwrap();
        assert_eq!((fields.len(), &others[..]), (2, &[][..]), "{attributes:?}");
        let expected = centers(&to);
        for (axis, field) in fields.iter().enumerate() {
            for (value, expected) in field.values().iter().zip(&expected) {
                assert!((value - expected[axis]).abs() < 1e-9, "{value} {expected:?}");
            }
        }
        let (fields, _) = file.centers(file.points()).unwrap();
        file.write_with_fields(&folder.path("out.nc"), file.points(), &fields).unwrap();
        assert!(fs::read(folder.path("out.nc")).unwrap() == bytes);
    }
}

/// In this file, attributes have their texts in a heap, and y comes before x.
#[test]
fn a_file_by_h5netcdf_is_read() {
    let file = MeshFile::read(&hdf5::made("h5netcdf.nc")).unwrap();
    assert_eq!(file.format(), Format::Ugrid);
    assert_eq!(file.data_names(), ["depth"]);
    assert_eq!(file.vertex_location(4).id, 4);
    let file = MeshFile::read(&hdf5::made("ugrid.nc")).unwrap();
    assert_eq!(file.data_names(), ["T"]);
    assert_eq!(file.vertex_location(4).id, 5);
}

/// The message names the filter, and does not say that coordinates are missing.
#[test]
fn coordinates_packed_by_a_filter_that_is_not_read_are_refused_by_its_name() {
    hdf5::refused(
        MeshFile::read(&hdf5::made("zstd.nc")),
        &[
            "zstd.nc, byte ",
            "cannot read a dataset compressed by Zstandard. Rewrite it with `h5repack",
        ],
    );
}

fn refused(bytes: &[u8], parts: &[&str]) {
    let folder = Folder::new(&[]);
    fs::write(folder.path("in.nc"), bytes).unwrap();
    let error = MeshFile::read(&folder.path("in.nc")).unwrap_err().to_string();
    assert!(parts.iter().all(|part| error.contains(part)), "{parts:?}: {error}");
}

/// Returns the bytes with the last occurrence of `from` replaced by `to`, a word of equal length.
fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    assert_eq!(from.len(), to.len());
    let at = bytes.windows(from.len()).rposition(|part| part == from.as_bytes()).unwrap();
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

#[test]
fn files_without_one_mesh_of_faces_are_refused_with_a_remedy() {
    let all = samples();
    let usual = all.last().unwrap();
    let refuse = |from: &str, to: &str, parts: &[&str]| {
        refused(&replaced(&usual.bytes, from, to), parts);
    };
    refuse(
        "bay_y bay_x lon",
        "bay_y bay_q    ",
        &["in.nc, byte ", "bay has no two variables that"],
    );
    refuse("bay_y bay_x lon", "lon level      ", &["lon and level are not two lists of real"]);
    refuse("bay_y bay_x lon", "bay_x bay_x    ", &["bay_x and bay_x are not two lists"]);
    let no_faces = replaced(&usual.bytes, "face_node_connectivity", "face_face_connectivity");
    refused(&no_faces, &["bay has no variable that its face_node_connectivity names"]);
    // Offsets of the topological dimensions of both meshes in the file.
    let dimension = b"topology_dimension\0\0\0\0\0\x04\0\0\0\x01\0\0\0";
    let places: Vec<usize> = (0..usual.bytes.len() - dimension.len())
        .filter(|&at| usual.bytes[at..].starts_with(dimension))
        .map(|at| at + dimension.len())
        .collect();
    let [lines, faces] = places[..] else { panic!("{places:?}") };
    let mut bytes = usual.bytes.clone();
    bytes[lines] = 2;
    refused(
        &bytes,
        &["in.nc, byte 0: several meshes: network, bay. Save each mesh to a separate file"],
    );
    bytes[lines] = 1;
    bytes[faces] = 3;
    refused(&bytes, &["a UGRID file without a mesh of faces (topology_dimension 2)"]);
}

#[test]
fn faces_that_are_none_are_refused_by_number_and_place() {
    let all = samples();
    let usual = all.last().unwrap();
    let rows = usual.triangle.1.clone();
    let with = |face: usize, corner: usize, node: i32| {
        let mut bytes = usual.bytes.clone();
        let at = rows.start + 4 * (4 * face + corner);
        bytes[at..at + 4].copy_from_slice(&node.to_be_bytes());
        (bytes, format!("in.nc, byte {}: face {}", rows.start + 16 * face, face + 1))
    };
    let (bytes, place) = with(5, 2, -999);
    refused(&bytes, &[&place, " has 2 corners"]);
    let (bytes, place) = with(5, 1, -999);
    refused(&bytes, &[&place, " has a corner after a missing one"]);
    let (bytes, place) = with(5, 0, -7);
    refused(&bytes, &[&place, " has the corner -7, which is no node"]);
}

/// A row of the table is a face unless the dimension of the faces says otherwise, however few faces the mesh has. Columns
/// of a file that names no dimension repeat nodes in their rows.
#[test]
fn a_mesh_may_have_fewer_faces_than_a_face_has_corners() {
    let faces: [[i32; 5]; 4] =
        [[0, 1, 8, -1, -1], [1, 2, 3, 8, -1], [3, 4, 5, 8, -1], [5, 6, 7, 0, 8]];
    let columns = (0..5).flat_map(|corner| faces.iter().map(move |face| face[corner])).collect();
    let rows = faces.concat();
    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Dimension {
        Named,
        OfPositions,
        OfData,
        Unnamed,
    }
    for (axes, table, is_of_columns) in
        [(["face", "corner"], rows, false), (["corner", "face"], columns, true)]
    {
        for dimension in
            [Dimension::Named, Dimension::OfPositions, Dimension::OfData, Dimension::Unnamed]
        {
            if is_of_columns && dimension == Dimension::Unnamed {
                continue;
            }
            let mut file = NetCdf::new(1);
            file.ints("mesh", &[], &[0]);
            file.attribute("cf_role", Attribute::Text("mesh_topology"));
            file.attribute("topology_dimension", Attribute::Whole(2));
            file.attribute("node_coordinates", Attribute::Text("x y"));
            file.attribute("face_node_connectivity", Attribute::Text("faces"));
            match dimension {
                Dimension::Named => file.attribute("face_dimension", Attribute::Text("face")),
                Dimension::OfPositions => {
                    file.attribute("face_coordinates", Attribute::Text("face_x face_y"));
                    file.reals("face_x", Precision::Double, &["face"], &[0.0; 4]);
                    file.reals("face_y", Precision::Double, &["face"], &[0.0; 4]);
                }
                Dimension::OfData => {
                    file.ints("n", &["face"], &[1, 2, 3, 4]);
                    file.attribute("location", Attribute::Text("face"));
                }
                Dimension::Unnamed => {}
            }
            file.ints("faces", &axes, &table);
            file.attribute("_FillValue", Attribute::Whole(-1));
            for (axis, name) in ["x", "y"].into_iter().enumerate() {
                let angles = (0..8).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_4);
                let around = angles.map(|angle| [angle.cos(), angle.sin()][axis]);
                file.reals(
                    name,
                    Precision::Double,
                    &["node"],
                    &around.chain([0.0]).collect::<Vec<_>>(),
                );
            }
            let folder = Folder::new(&[]);
            folder.put("a.nc", file.build(&[("node", 9), ("face", 4), ("corner", 5)], 0).bytes);
            let read = folder.read("a.nc");
            let counts = (read.triangles().len(), read.quadrilaterals().len());
            assert_eq!(counts, (1, 2), "{axes:?}, {dimension:?}");
        }
    }
}
