//! Makes Exodus II files in the three classic forms of netCDF.

use super::binary::size_of;
use super::netcdf::{Attribute, NetCdf, RECORDS};
use super::{LINE, Made, PROBED, QUADRILATERAL, SECOND_REGION, fixing, regions, z};
use mesh_io::Format;
use mesh_io::Precision;
use support::Mesh;

pub(super) fn all(mesh: &Mesh) -> Vec<Made> {
    let of = |version: u8, precision, axes| exodus(mesh, version, precision, axes);
    vec![
        of(1, Precision::Double, Axes::Apart),
        of(1, Precision::Single, Axes::Together),
        of(2, Precision::Double, Axes::Apart),
        of(5, Precision::Double, Axes::Together),
    ]
}

/// Whether x, y and z are separate variables or one variable.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Axes {
    Apart,
    Together,
}

const DIMENSIONS: [&str; 14] = [
    "len_name",
    RECORDS,
    "num_dim",
    "num_nodes",
    "num_elem",
    "num_el_in_blk1",
    "num_el_in_blk3",
    "three",
    "four",
    "two",
    "num_side_ss1",
    "num_nod_ns1",
    "one",
    "num_el_blk",
];

/// Adds a block of elements.
fn connect(file: &mut NetCdf, block: usize, of: &[&'static str; 3], elements: &[Vec<u32>]) {
    let numbers: Vec<i32> = elements.iter().flatten().map(|&v| v as i32 + 1).collect();
    file.ints(&format!("connect{block}"), &of[1..], &numbers);
    file.attribute("elem_type", Attribute::Text(of[0]));
}

fn exodus(mesh: &Mesh, version: u8, precision: Precision, axes: Axes) -> Made {
    let (n, m) = (mesh.points.len(), mesh.triangles.len());
    let mut file = NetCdf::new(version);
    let lengths = [16, 0, 3, n, m + 2, SECOND_REGION, m - SECOND_REGION, 3, 4, 2, 2, 3, 1, 4];
    file.ints("eb_prop1", &["num_el_blk"], &[5, 7, 2, 9]);
    file.names("eb_names", &["num_el_blk", "len_name"], &["steel", "", "", "wire"]);
    let axis = |axis: usize| mesh.points.iter().map(|p| p[axis]).collect::<Vec<_>>();
    let heights: Vec<f64> = (0..n).map(z).collect();
    let coordinates = [axis(0), axis(1), heights];
    match axes {
        Axes::Apart => {
            for (name, numbers) in ["coordx", "coordy", "coordz"].iter().zip(&coordinates) {
                file.reals(name, precision, &["num_nodes"], numbers);
            }
        }
        Axes::Together => {
            file.reals("coord", precision, &["num_dim", "num_nodes"], &coordinates.concat());
        }
    }
    let corners: Vec<Vec<u32>> = mesh.triangles.iter().map(|t| t.to_vec()).collect();
    let [first, second] = [&corners[..SECOND_REGION], &corners[SECOND_REGION..]];
    connect(&mut file, 1, &["TRI3", "num_el_in_blk1", "three"], first);
    // The order of blocks determines element numbers, whatever the order of the variables.
    connect(&mut file, 3, &["tri", "num_el_in_blk3", "three"], second);
    connect(&mut file, 2, &["SHELL4\0", "one", "four"], &[QUADRILATERAL.to_vec()]);
    connect(&mut file, 4, &["BAR2", "one", "two"], &[LINE.to_vec()]);
    // The side set has the edge between the first two vertices of triangle 0, and the first edge of the shell. In space,
    // sides 1 and 2 of both are faces.
    let shell = SECOND_REGION as i32 + 1;
    file.ints("ss_prop1", &["one"], &[40]);
    file.names("ss_names", &["one", "len_name"], &["shore"]);
    file.ints("elem_ss1", &["num_side_ss1"], &[1, shell]);
    file.ints("side_ss1", &["num_side_ss1"], &[3, 3]);
    file.ints("node_ns1", &["num_nod_ns1"], &[1, 13, 15]);
    file.names("name_nod_var", &["two", "len_name"], &["T", "p"]);
    file.ints("elem_num_map", &["one"], &[1]);
    for variable in 1..=2 {
        let numbers: Vec<f64> = (0..n).map(|i| (i * variable) as f64 * 0.5).collect();
        let name = format!("vals_nod_var{variable}");
        file.reals(&name, precision, &[RECORDS, "num_nodes"], &numbers);
    }
    build(file, &lengths, mesh, precision)
}

/// Finishes the file of these variables, with two time steps.
fn build(file: NetCdf, lengths: &[usize; 14], mesh: &Mesh, precision: Precision) -> Made {
    let version = file.version;
    let dimensions: Vec<_> = DIMENSIONS.into_iter().zip(lengths.iter().copied()).collect();
    let built = file.build(&dimensions, 2);
    let (size, n) = (size_of(precision), mesh.points.len());
    let x = built.variable("coordx").or(built.variable("coord")).unwrap().start;
    let y = built.variable("coordy").map_or(x + n * size, |y| y.start);
    let [a, b, _] = mesh.triangles[0];
    let shell = [QUADRILATERAL[0], QUADRILATERAL[1]];
    let fixed = QUADRILATERAL.into_iter().chain(LINE).chain([a, b]).chain(shell);
    Made {
        what: format!("Exodus II, version {version} of netCDF, {precision:?}"),
        name: "in.exo",
        format: Format::Exodus,
        precision,
        mesh: fixing(mesh, fixed),
        regions: regions(mesh),
        vertex: (u64::from(PROBED.0) + 1, x..y + n * size),
        triangle: (PROBED.1 as u64 + 1, built.variable("connect1").unwrap()),
        lists: built.lists(),
        counts: built.lengths(&["num_nodes", "num_el_in_blk1", "num_side_ss1"]),
        coordinates: (0..n).map(|i| [x + i * size, y + i * size]).collect(),
        big: true,
        bytes: built.bytes,
    }
}
