//! The mesh of a UGRID file: the variables of its coordinates and faces.

use crate::error::ReadError;
use crate::formats::axes::{Axes, BinaryReals};
use crate::formats::netcdf_axes::axes;
use crate::netcdf::{Header, NumberType, Variable};
use crate::text::cursor::Cursor;
use crate::text::token::quoted;

/// A two-dimensional mesh and its variables.
pub(super) struct Mesh<'h, 'a> {
    pub(super) header: &'h Header<'a>,
    /// The mesh variable, with the `cf_role` `mesh_topology`.
    pub(super) own: &'h Variable,
    /// Variable of x or longitude, with a number per node.
    pub(super) x: &'h Variable,
    /// Variable of y or latitude, of the same type, byte order and shape as `x`.
    pub(super) y: &'h Variable,
    /// Number of nodes.
    pub(super) nodes: usize,
    /// Connectivity variable: the nodes of each face.
    pub(super) face_nodes: &'h Variable,
}

/// Returns whether a variable is the mesh variable of a UGRID mesh, of any dimension.
pub(super) fn is_mesh(variable: &Variable) -> bool {
    variable.text("cf_role") == Some(b"mesh_topology")
}

/// Units of longitudes and latitudes by the CF conventions, sections 4.1 and 4.2.
const DEGREES_EAST: [&[u8]; 6] =
    [b"degrees_east", b"degree_east", b"degree_E", b"degrees_E", b"degreeE", b"degreesE"];
const DEGREES_NORTH: [&[u8]; 6] =
    [b"degrees_north", b"degree_north", b"degree_N", b"degrees_N", b"degreeN", b"degreesN"];

const REMEDY: &str = "Write it again by the UGRID conventions, or save the mesh in another format";

impl<'h, 'a> Mesh<'h, 'a> {
    /// Finds the two-dimensional mesh of a file. A mesh without `topology_dimension` counts as two-dimensional.
    ///
    /// # Errors
    /// If the file has no such mesh or several, or if variables of coordinates or faces are missing or unsuitable.
    pub(super) fn find(header: &'h Header<'a>) -> Result<Mesh<'h, 'a>, ReadError> {
        let has_faces = |variable: &&Variable| {
            variable.whole("topology_dimension").is_none_or(|dimension| dimension == 2)
        };
        let all = header.variables.iter().filter(|variable| is_mesh(variable));
        let of_faces: Vec<_> = all.filter(has_faces).collect();
        let start = Cursor::at_byte_offset(header.source, 0);
        let own = match of_faces[..] {
            [own] => own,
            [] => {
                let problem = "a UGRID file without a mesh of faces (topology_dimension 2)";
                return Err(start.error(problem, "Save the mesh with its faces"));
            }
            _ => {
                let names: Vec<_> = of_faces.iter().map(|own| quoted(&own.name)).collect();
                let problem = format!("several meshes: {}", names.join(", "));
                return Err(start.error(problem, "Save each mesh to a separate file"));
            }
        };
        let parts = ["node_coordinates", "face_node_connectivity"];
        let is_part = |name: &[u8]| {
            parts.iter().flat_map(|attribute| names(own, attribute)).any(|own| own == name)
        };
        if let Some(error) = header.unread(is_part) {
            return Err(error);
        }
        let [x, y] = coordinates(header, own)?;
        let nodes = node_count(header, [x, y])?;
        let named = own.text("face_node_connectivity");
        let Some(face_nodes) = named.and_then(|name| variable(header, name)) else {
            let problem = format!(
                "the mesh {} has no variable that its face_node_connectivity names, so no faces",
                quoted(&own.name)
            );
            let place = Cursor::at_byte_offset(header.source, header.start_of(own));
            return Err(place.error(problem, REMEDY));
        };
        Ok(Mesh { header, own, x, y, nodes, face_nodes })
    }

    /// Returns whether attributes say that x is longitude and y latitude.
    pub(super) fn is_in_degrees(&self) -> bool {
        const NAMES: [(&[u8], &[&[u8]]); 2] =
            [(b"longitude", &DEGREES_EAST), (b"latitude", &DEGREES_NORTH)];
        [self.x, self.y].into_iter().zip(NAMES).all(|(variable, (name, units))| {
            variable.text("standard_name") == Some(name)
                || variable.text("units").is_some_and(|unit| units.contains(&unit))
        })
    }

    /// Locates the coordinates of the nodes.
    ///
    /// # Errors
    /// If the content of a coordinate variable cannot be read.
    pub(super) fn axes(&self) -> Result<Axes<'a>, ReadError> {
        let Mesh { header, x, y, nodes, .. } = self;
        let NumberType::Real(precision) = x.number else {
            return Err(unfit(header, [x, y]));
        };
        axes(header, &[x, y], BinaryReals { order: x.order, precision }, 2, *nodes)
    }

    /// Returns the variables named by an attribute of the mesh variable, without names that the file lacks.
    pub(super) fn named(&self, attribute: &str) -> Vec<&'h Variable> {
        names(self.own, attribute).filter_map(|name| self.variable(name)).collect()
    }

    pub(super) fn variable(&self, name: &[u8]) -> Option<&'h Variable> {
        variable(self.header, name)
    }
}

/// Returns the words of an attribute: names of variables, separated by blanks.
fn names<'v>(variable: &'v Variable, attribute: &str) -> impl Iterator<Item = &'v [u8]> + use<'v> {
    let text = variable.text(attribute).unwrap_or_default();
    text.split(u8::is_ascii_whitespace).filter(|name| !name.is_empty())
}

fn variable<'h>(header: &'h Header<'_>, name: &[u8]) -> Option<&'h Variable> {
    header.variables.iter().find(|variable| variable.name == name)
}

/// Returns the variables of x and y, or of longitude and latitude, in this order. If `node_coordinates` names more than
/// two variables, the first two count.
fn coordinates<'h>(header: &'h Header<'_>, own: &Variable) -> Result<[&'h Variable; 2], ReadError> {
    let named = names(own, "node_coordinates").filter_map(|name| variable(header, name));
    let found: Vec<_> = named.take(2).collect();
    match found[..] {
        [first, second] if axis_of(first) == Some(1) && axis_of(second) != Some(1) => {
            Ok([second, first])
        }
        [first, second] => Ok([first, second]),
        _ => {
            let problem = format!(
                "the mesh {} has no two variables that its node_coordinates names",
                quoted(&own.name)
            );
            let place = Cursor::at_byte_offset(header.source, header.start_of(own));
            Err(place.error(problem, REMEDY))
        }
    }
}

/// Returns the axis of a coordinate variable by its attributes: 0 for x or longitude, 1 for y or latitude, `None` if no
/// attribute names an axis.
pub(super) fn axis_of(variable: &Variable) -> Option<usize> {
    const AXIS_ATTRIBUTES: [(&str, [&[&[u8]]; 2]); 3] = [
        (
            "standard_name",
            [
                &[b"longitude", b"projection_x_coordinate"],
                &[b"latitude", b"projection_y_coordinate"],
            ],
        ),
        ("axis", [&[b"X"], &[b"Y"]]),
        ("units", [&DEGREES_EAST, &DEGREES_NORTH]),
    ];
    AXIS_ATTRIBUTES.iter().find_map(|(attribute, axes)| {
        let text = variable.text(attribute)?;
        axes.iter().position(|values| values.contains(&text))
    })
}

fn node_count(header: &Header<'_>, [x, y]: [&Variable; 2]) -> Result<usize, ReadError> {
    let is_real = matches!(x.number, NumberType::Real(_));
    let is_same = (x.number, x.order, &x.shape) == (y.number, y.order, &y.shape);
    match x.shape[..] {
        [count] if is_real && is_same && !x.is_record && !y.is_record && x.name != y.name => {
            Cursor::at_byte_offset(header.source, header.start_of(x)).check_vertex_count(count)?;
            Ok(count as usize)
        }
        _ => Err(unfit(header, [x, y])),
    }
}

#[cold]
fn unfit(header: &Header<'_>, [x, y]: [&Variable; 2]) -> ReadError {
    let problem = format!(
        "{} and {} are not two lists of real numbers, one for each node, of the same type",
        quoted(&x.name),
        quoted(&y.name)
    );
    Cursor::at_byte_offset(header.source, header.start_of(x)).error(problem, REMEDY)
}
