//! Makes UGRID files in the three classic forms of netCDF.

use super::binary::size_of;
use super::netcdf::{Attribute, Built, NetCdf, RECORDS};
use super::{Made, PROBED, QUADRILATERAL, cells, fixing, triples};
use mesh_io::Format;
use mesh_io::Precision;
use support::Mesh;

/// Properties in which the sample files differ.
struct Style {
    version: u8,
    precision: Precision,
    faces: Faces,
    /// Number of the first node.
    first: u32,
    /// Whether the attribute `start_index` gives the first node number.
    says_first: bool,
    /// Whether variable y precedes variable x in the file.
    is_turned: bool,
}

/// Layout of the nodes of faces.
#[derive(Clone, Copy, PartialEq)]
enum Faces {
    /// A row of three nodes for each triangle, without any other faces.
    Triangles,
    /// A row for each face, padded with this value of the attribute `_FillValue`.
    Rows(i32),
    /// A column for each face, padded with -1, which no attribute of the file explains.
    Columns,
    /// A row of real numbers for each face, padded with NaN.
    Real,
}

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    let (precision, says_first) = (Precision::Double, true);
    let usual = Style {
        version: 1,
        precision,
        faces: Faces::Rows(-999),
        first: 1,
        says_first,
        is_turned: false,
    };
    let single = Precision::Single;
    [
        Style { version: 2, faces: Faces::Columns, first: 0, is_turned: true, ..usual },
        Style {
            version: 5,
            faces: Faces::Real,
            first: 0,
            says_first: false,
            precision: single,
            ..usual
        },
        Style { faces: Faces::Triangles, says_first: false, ..usual },
        usual,
    ]
    .iter()
    .map(|style| ugrid(mesh, style))
    .collect()
}

fn ugrid(mesh: &Mesh, style: &Style) -> Made {
    let &Style { version, precision, faces, first, says_first, is_turned } = style;
    let mut file = NetCdf::new(version);
    let is_mixed = faces != Faces::Triangles;
    let elements = if is_mixed { cells(mesh) } else { triples(mesh) };
    let (n, m, corners) = (mesh.points.len(), elements.len(), if is_mixed { 4 } else { 3 });
    // A second mesh, of lines, which the reader must ignore.
    file.ints("network", &[], &[0]);
    file.attribute("cf_role", Attribute::Text("mesh_topology"));
    file.attribute("topology_dimension", Attribute::Whole(1));
    file.ints("bay", &[], &[0]);
    file.attribute("cf_role", Attribute::Text("mesh_topology"));
    file.attribute("topology_dimension", Attribute::Whole(2));
    file.attribute("node_coordinates", Attribute::Text("bay_y bay_x lon"));
    file.attribute("face_node_connectivity", Attribute::Text("bay_faces"));
    file.attribute("face_coordinates", Attribute::Text("face_x face_y"));
    let nodes = elements.iter().map(|face| {
        let mut row: Vec<i32> = face.iter().map(|&v| (v + first) as i32).collect();
        row.resize(corners, if let Faces::Rows(missing) = faces { missing } else { -1 });
        row
    });
    let nodes: Vec<Vec<i32>> = nodes.collect();
    match faces {
        Faces::Triangles | Faces::Rows(_) => {
            file.ints("bay_faces", &["face", "corner"], &nodes.concat());
        }
        Faces::Columns => {
            let columns: Vec<i32> =
                (0..corners).flat_map(|corner| nodes.iter().map(move |row| row[corner])).collect();
            file.ints("bay_faces", &["corner", "face"], &columns);
        }
        Faces::Real => {
            let of = |&node: &i32| if node < 0 { f64::NAN } else { f64::from(node) };
            let numbers: Vec<f64> = nodes.concat().iter().map(of).collect();
            file.reals("bay_faces", Precision::Double, &["face", "corner"], &numbers);
        }
    }
    if says_first {
        // Some programs write `start_index` as a real number.
        let real = Attribute::Real(f64::from(first));
        let whole = Attribute::Whole(first as i32);
        file.attribute("start_index", if version == 1 { real } else { whole });
    }
    if let Faces::Rows(missing) = faces {
        file.attribute("_FillValue", Attribute::Whole(missing));
    }
    let axes = [("bay_x", 0, "projection_x_coordinate"), ("bay_y", 1, "projection_y_coordinate")];
    for place in [usize::from(is_turned), usize::from(!is_turned)] {
        let (name, axis, meaning) = axes[place];
        let numbers: Vec<f64> = mesh.points.iter().map(|point| point[axis]).collect();
        file.reals(name, precision, &["node"], &numbers);
        file.attribute("standard_name", Attribute::Text(meaning));
    }
    data(&mut file, precision, n, m);
    centers(&mut file, mesh, &elements);
    let lengths = [("node", n), ("face", m), ("corner", corners), ("layer", 2), (RECORDS, 0)];
    let built = file.build(&lengths, 2);
    made(mesh, style, built)
}

/// Adds data of nodes and faces: depths with one missing value, velocities in layers, and water levels in time steps.
fn data(file: &mut NetCdf, precision: Precision, nodes: usize, faces: usize) {
    let numbers = |count: usize, by: f64| (0..count).map(|i| i as f64 * by).collect::<Vec<_>>();
    file.reals("lon", precision, &["node"], &numbers(nodes, 0.25));
    let mut depths = numbers(nodes, -0.5);
    depths[3] = -99.0;
    file.reals("bay_node_z", precision, &["node"], &depths);
    file.attribute("mesh", Attribute::Text("bay"));
    file.attribute("location", Attribute::Text("node"));
    file.attribute("_FillValue", Attribute::Real(-99.0));
    file.reals("u", precision, &["node", "layer"], &numbers(2 * nodes, 0.125));
    file.attribute("location", Attribute::Text("node"));
    file.reals("level", precision, &[RECORDS, "node"], &numbers(nodes, 2.0));
    file.attribute("location", Attribute::Text("node"));
    file.ints("dry", &[RECORDS, "face"], &vec![1; faces]);
    file.attribute("location", Attribute::Text("face"));
}

/// Adds centers of faces: x is the mean of the corners, y is not.
fn centers(file: &mut NetCdf, mesh: &Mesh, faces: &[Vec<u32>]) {
    // A corner beyond the vertices counts as 0.
    let x = |&v: &u32| mesh.points.get(v as usize).map_or(0.0, |point| point[0]);
    let mean = |face: &Vec<u32>| face.iter().map(x).sum::<f64>() / face.len() as f64;
    let means: Vec<f64> = faces.iter().map(mean).collect();
    file.reals("face_x", Precision::Double, &["face"], &means);
    file.reals("face_y", Precision::Double, &["face"], &vec![-0.75; faces.len()]);
}

fn made(mesh: &Mesh, style: &Style, built: Built) -> Made {
    let &Style { version, precision, faces, first, .. } = style;
    let (size, n) = (size_of(precision), mesh.points.len());
    let [x, y] = ["bay_x", "bay_y"].map(|name| built.variable(name).unwrap());
    let is_mixed = faces != Faces::Triangles;
    let fixed = if is_mixed { QUADRILATERAL.to_vec() } else { Vec::new() };
    // The quadrilateral comes before triangle 10.
    let place = PROBED.1 as u64 + u64::from(is_mixed);
    Made {
        what: format!("UGRID, version {version} of netCDF, {precision:?}"),
        name: "in.nc",
        format: Format::Ugrid,
        precision,
        mesh: fixing(mesh, fixed),
        regions: None,
        vertex: (u64::from(PROBED.0 + first), x.start.min(y.start)..x.end.max(y.end)),
        triangle: (place + u64::from(first), built.variable("bay_faces").unwrap()),
        lists: built.lists(),
        counts: built.lengths(&["node", "face"]),
        coordinates: (0..n).map(|i| [x.start + i * size, y.start + i * size]).collect(),
        big: true,
        bytes: built.bytes,
    }
}

/// Makes a file in degrees, with triangles alone and longitudes and latitudes of the centers of faces. `attributes` are
/// the name and the values, for longitude and latitude, of the attribute by which the file says so.
pub(crate) fn in_degrees(
    mesh: &Mesh,
    centers: &[[f64; 2]],
    attributes: [&'static str; 3],
) -> Vec<u8> {
    let mut file = NetCdf::new(1);
    file.ints("bay", &[], &[0]);
    file.attribute("cf_role", Attribute::Text("mesh_topology"));
    file.attribute("topology_dimension", Attribute::Whole(2));
    file.attribute("node_coordinates", Attribute::Text("x y"));
    file.attribute("face_node_connectivity", Attribute::Text("faces"));
    file.attribute("face_coordinates", Attribute::Text("face_x face_y"));
    let nodes: Vec<i32> = mesh.triangles.as_flattened().iter().map(|&v| v as i32).collect();
    file.ints("faces", &["face", "corner"], &nodes);
    let [attribute, values @ ..] = attributes;
    for (points, dimension, names) in
        [(&mesh.points[..], "node", ["x", "y"]), (centers, "face", ["face_x", "face_y"])]
    {
        for (axis, name) in names.into_iter().enumerate() {
            let numbers: Vec<f64> = points.iter().map(|point| point[axis]).collect();
            file.reals(name, Precision::Double, &[dimension], &numbers);
            file.attribute(attribute, Attribute::Text(values[axis]));
        }
    }
    let lengths = [("node", mesh.points.len()), ("face", centers.len()), ("corner", 3)];
    file.build(&lengths, 0).bytes
}
