//! The mesh of a UGRID file: the variables of its coordinates and faces.

use super::kind::TableKind;
use crate::error::ReadError;
use crate::formats::axes::{Axes, BinaryReals};
use crate::formats::netcdf_axes::axes;
use crate::netcdf::{Header, NumberType, Variable};
use crate::text::cursor::Cursor;
use crate::text::token::quoted;

/// A two-dimensional mesh and its variables.
pub(super) struct Mesh<'h, 'a> {
    pub(super) header: &'h Header<'a>,
    /// The mesh variable, with the `cf_role` `mesh_topology`. `None` in older nets of Delft3D FM, whose variables have
    /// fixed names.
    pub(super) own: Option<&'h Variable>,
    /// Variable of x or longitude, with a number per node.
    pub(super) x: &'h Variable,
    /// Variable of y or latitude, of the same type, byte order and shape as `x`.
    pub(super) y: &'h Variable,
    /// Number of nodes.
    pub(super) nodes: usize,
    /// Connectivity variable: the nodes of each face, or of each edge in a file without faces.
    pub(super) connectivity: (TableKind, &'h Variable),
}

/// Names of variables and of the dimension of edges in older nets of Delft3D FM, by the attribute of UGRID that would
/// name them.
const NET_NAMES: [(&str, &str); 3] = [
    ("node_coordinates", "NetNode_x NetNode_y"),
    ("edge_node_connectivity", "NetLink"),
    ("edge_dimension", "nNetLink"),
];

/// Returns whether a variable is the mesh variable of a UGRID mesh, of any dimension.
pub(super) fn is_mesh(variable: &Variable) -> bool {
    variable.text("cf_role") == Some(b"mesh_topology")
}

/// Returns whether a file is an older net of Delft3D FM.
pub(super) fn is_net(header: &Header<'_>) -> bool {
    ["NetNode_x", "NetNode_y", "NetLink"].iter().all(|name| header.variable(name).is_some())
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
    /// If the file has no such mesh or several, or if variables of coordinates, or of both faces and edges, are missing or
    /// unsuitable.
    pub(super) fn find(header: &'h Header<'a>) -> Result<Mesh<'h, 'a>, ReadError> {
        let own = mesh_variable(header)?;
        let is_part = |attribute: &'static str| {
            move |name: &[u8]| words(attribute_of(own, attribute)).any(|own| own == name)
        };
        let unread = |attribute| header.unread(is_part(attribute)).map_or(Ok(()), Err);
        unread("node_coordinates")?;
        unread("face_node_connectivity")?;
        let [x, y] = coordinates(header, own)?;
        let nodes = node_count(header, [x, y])?;
        let named = |attribute| variable(header, attribute_of(own, attribute));
        let connectivity = match named("face_node_connectivity") {
            Some(faces) => (TableKind::Faces, faces),
            None => {
                unread("edge_node_connectivity")?;
                let edges =
                    named("edge_node_connectivity").ok_or_else(|| without_faces(header, own))?;
                (TableKind::Edges, edges)
            }
        };
        Ok(Mesh { header, own, x, y, nodes, connectivity })
    }

    /// Returns whether the file is an older net of Delft3D FM, of nodes and links.
    pub(super) fn is_of_links(&self) -> bool {
        self.own.is_none()
    }

    /// Returns the text of an attribute of the mesh variable, or the name that stands for it in an older net of D-Flow
    /// FM; empty without either.
    pub(super) fn attribute(&self, attribute: &str) -> &'h [u8] {
        attribute_of(self.own, attribute)
    }

    /// Returns the number of faces or edges by their positions, or else by data with this `location`. `None` without such
    /// variables of one dimension.
    pub(super) fn element_count(&self, kind: TableKind) -> Option<u64> {
        let (location, _, _, _) = kind.words();
        let positions = self.named(&format!("{location}_coordinates")).into_iter();
        let is_own = |variable: &&Variable| {
            let is_of_mesh = variable.text("mesh").is_none_or(|mesh| self.is_own(mesh));
            is_of_mesh && variable.text("location") == Some(location.as_bytes())
        };
        let mut counted = positions.chain(self.header.variables.iter().filter(is_own));
        counted.find_map(|variable| match variable.shape[..] {
            [count] => Some(count),
            _ => None,
        })
    }

    /// Returns whether `name` is the name of the mesh variable.
    pub(super) fn is_own(&self, name: &[u8]) -> bool {
        self.own.is_some_and(|own| own.name == name)
    }

    /// Returns whether attributes say that x is longitude and y latitude in degrees, or that coordinates have another unit.
    /// `None` if attributes say neither. Units take precedence over standard names, as longitudes may be in radians.
    pub(super) fn says_degrees(&self) -> Option<bool> {
        const NAMES: [(&[u8], &[&[u8]]); 2] =
            [(b"longitude", &DEGREES_EAST), (b"latitude", &DEGREES_NORTH)];
        let of = |variable: &Variable, (name, units): (&[u8], &[&[u8]])| {
            let is_angle = variable.text("standard_name") == Some(name);
            match variable.text("units").unwrap_or_default() {
                b"" => is_angle.then_some(true),
                unit if units.contains(&unit) => Some(true),
                b"degrees" | b"degree" => is_angle.then_some(true),
                _ => Some(false),
            }
        };
        let [x, y] = [0, 1].map(|axis| of([self.x, self.y][axis], NAMES[axis]));
        (x == y).then_some(x)?
    }

    /// Returns whether attributes say that x is longitude and y latitude in degrees.
    pub(super) fn is_in_degrees(&self) -> bool {
        self.says_degrees() == Some(true)
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
        words(self.attribute(attribute)).filter_map(|name| self.variable(name)).collect()
    }

    pub(super) fn variable(&self, name: &[u8]) -> Option<&'h Variable> {
        variable(self.header, name)
    }
}

/// Returns the mesh variable; `None` for an older net of Delft3D FM.
fn mesh_variable<'h>(header: &'h Header<'_>) -> Result<Option<&'h Variable>, ReadError> {
    let has_faces = |variable: &&Variable| {
        variable.whole("topology_dimension").is_none_or(|dimension| dimension == 2)
    };
    let all: Vec<_> = header.variables.iter().filter(|variable| is_mesh(variable)).collect();
    if all.is_empty() && is_net(header) {
        return Ok(None);
    }
    let of_faces: Vec<_> = all.into_iter().filter(has_faces).collect();
    let start = Cursor::at_byte_offset(header.source, 0);
    match of_faces[..] {
        [own] => Ok(Some(own)),
        [] => {
            let problem = "a UGRID file without a mesh of faces (topology_dimension 2)";
            Err(start.error(problem, "Save the mesh with its faces"))
        }
        _ => {
            let names: Vec<_> = of_faces.iter().map(|own| quoted(&own.name)).collect();
            let problem = format!("several meshes: {}", names.join(", "));
            Err(start.error(problem, "Save each mesh to a separate file"))
        }
    }
}

/// Returns the text of an attribute of the mesh variable, or the name of [`NET_NAMES`].
fn attribute_of<'h>(own: Option<&'h Variable>, attribute: &str) -> &'h [u8] {
    match own {
        Some(own) => own.text(attribute).unwrap_or_default(),
        None => {
            let known = NET_NAMES.iter().find(|(known, _)| *known == attribute);
            known.map_or(b"", |(_, name)| name.as_bytes())
        }
    }
}

/// Returns the words of a text: names of variables, separated by blanks.
fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace).filter(|name| !name.is_empty())
}

fn variable<'h>(header: &'h Header<'_>, name: &[u8]) -> Option<&'h Variable> {
    header.variables.iter().find(|variable| variable.name == name)
}

/// Returns the variables of x and y, or of longitude and latitude, in this order. If `node_coordinates` names more than
/// two variables, the first two count.
fn coordinates<'h>(
    header: &'h Header<'_>,
    own: Option<&'h Variable>,
) -> Result<[&'h Variable; 2], ReadError> {
    let named = words(attribute_of(own, "node_coordinates"));
    let found: Vec<_> = named.filter_map(|name| variable(header, name)).take(2).collect();
    match found[..] {
        [first, second] if axis_of(first) == Some(1) && axis_of(second) != Some(1) => {
            Ok([second, first])
        }
        [first, second] => Ok([first, second]),
        _ => Err(lacking(header, own, "has no two variables that its node_coordinates names")),
    }
}

#[cold]
fn without_faces(header: &Header<'_>, own: Option<&Variable>) -> ReadError {
    let lack = "has no variable that its face_node_connectivity names, and none that its \
                edge_node_connectivity names, so neither faces nor edges";
    lacking(header, own, lack)
}

#[cold]
fn lacking(header: &Header<'_>, own: Option<&Variable>, lack: &str) -> ReadError {
    let (name, start) =
        own.map_or((String::new(), 0), |own| (quoted(&own.name), header.start_of(own)));
    Cursor::at_byte_offset(header.source, start).error(format!("the mesh {name} {lack}"), REMEDY)
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
