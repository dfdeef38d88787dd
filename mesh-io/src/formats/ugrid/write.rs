//! Writer of UGRID in netCDF's classic format with 64-bit offsets.
//!
//! The format: <https://ugrid-conventions.github.io/ugrid-conventions>, version 1.0. Variables have the names that
//! programs of this format usually give them. Node numbers start at 1.

use crate::export::content::DataArray;
use crate::export::writer_input::WriterInput;
use crate::netcdf::write::{NetCdfWriter, Values};

/// Names of the mesh variable, coordinates and faces. Data variables must have other names.
pub(crate) const NAMES: [&str; 4] =
    ["mesh2d", "mesh2d_node_x", "mesh2d_node_y", "mesh2d_face_nodes"];

const MESH: &str = NAMES[0];
const X: &str = NAMES[1];
const Y: &str = NAMES[2];
const FACES: &str = NAMES[3];
const NODE_COUNT: &str = "mesh2d_nNodes";
const FACE_COUNT: &str = "mesh2d_nFaces";
const CORNERS: &str = "mesh2d_nMax_face_nodes";

/// Fill value of a connectivity table: marks the missing corners of a face.
const MISSING: i32 = -999;

pub(crate) fn write_ugrid(input: &WriterInput<'_>) -> Vec<u8> {
    let content = input.content;
    let cells: Vec<usize> = input.cells().collect();
    let corners = cells.iter().map(|&cell| content.cells.of(cell).len()).max().unwrap_or(3);
    let is_mixed = cells.iter().any(|&cell| content.cells.of(cell).len() < corners);
    let mut out = NetCdfWriter::default();
    out.attribute("Conventions", text("CF-1.8 UGRID-1.0"));
    out.attribute("title", text(&format!("written by {}", input.creator)));
    out.dimension(NODE_COUNT, content.points.len());
    out.dimension(FACE_COUNT, cells.len());
    out.dimension(CORNERS, corners);
    let mesh = vec![
        ("cf_role", text("mesh_topology")),
        ("topology_dimension", Values::Whole(vec![2])),
        ("node_coordinates", text(&format!("{X} {Y}"))),
        ("node_dimension", text(NODE_COUNT)),
        ("face_node_connectivity", text(FACES)),
        ("face_dimension", text(FACE_COUNT)),
    ];
    out.variable(MESH, &[], mesh, Values::Whole(vec![0]));
    for (axis, name) in [X, Y].into_iter().enumerate() {
        let numbers = content.points.iter().map(|point| point[axis]).collect();
        out.variable(name, &[NODE_COUNT], Vec::new(), Values::Real(numbers));
    }
    let row = |&cell: &usize| {
        let own = content.cells.of(cell);
        let nodes = own.iter().map(|&vertex| vertex as i32 + 1);
        nodes.chain(std::iter::repeat_n(MISSING, corners - own.len()))
    };
    let mut roles =
        vec![("cf_role", text("face_node_connectivity")), ("start_index", Values::Whole(vec![1]))];
    if is_mixed {
        roles.push(("_FillValue", Values::Whole(vec![MISSING])));
    }
    let nodes = Values::Whole(cells.iter().flat_map(row).collect());
    out.variable(FACES, &[FACE_COUNT, CORNERS], roles, nodes);
    for each in input.point_data() {
        data(&mut out, each, NODE_COUNT, "node", each.values.clone());
    }
    for each in input.cell_data() {
        let of = |&cell: &usize| {
            let start = cell * each.components;
            each.values.get(start..start + each.components).unwrap_or_default().iter().copied()
        };
        data(&mut out, each, FACE_COUNT, "face", cells.iter().flat_map(of).collect());
    }
    out.bytes()
}

/// Adds a variable with data of `count` nodes or faces.
fn data(out: &mut NetCdfWriter, data: &DataArray, count: &str, location: &str, values: Vec<f64>) {
    let attributes = vec![("mesh", text(MESH)), ("location", text(location))];
    let is_whole = |x: &f64| f64::from(*x as i32) == *x;
    let values = match !data.is_real && values.iter().all(is_whole) {
        true => Values::Whole(values.iter().map(|&x| x as i32).collect()),
        false => Values::Real(values),
    };
    if data.components == 1 {
        out.variable(&*data.name, &[count], attributes, values);
        return;
    }
    let each = format!("components{}", data.components);
    if !out.has_dimension(&each) {
        out.dimension(&*each, data.components);
    }
    out.variable(&*data.name, &[count, &each], attributes, values);
}

fn text(text: &str) -> Values {
    Values::Text(text.as_bytes().to_vec())
}
