//! Node and face data of a UGRID file.

use super::centers::Tables;
use super::kind::TableKind;
use super::mesh::Mesh;
use super::table::Table;
use crate::content::decoded::decoded;
use crate::content::remark::Remark;
use crate::formats::netcdf_points::{PointData, RecordParts};
use crate::netcdf::{NumberType, Variable};
use crate::text::token::join_first;
use crate::visit::visitor::MeshVisitor;

/// Start of the names of the variables of edges in older nets of Delft3D FM.
const LINK: &[u8] = b"NetLink";

/// Attributes of the mesh variable that name tables which follow from the faces.
const CONNECTIVITIES: [&str; 6] = [
    "edge_node_connectivity",
    "face_edge_connectivity",
    "face_face_connectivity",
    "edge_face_connectivity",
    "node_face_connectivity",
    "boundary_node_connectivity",
];
/// Tables of older nets of Delft3D FM that follow from the links.
const NET_TABLES: [&[u8]; 3] = [b"NetElemNode", b"NetElemLink", b"BndLink"];

/// Returns whether a variable has times, by the CF conventions, section 4.4.
fn is_time(variable: &Variable) -> bool {
    let units = variable.text("units").unwrap_or_default();
    variable.text("standard_name") == Some(b"time")
        || memchr::memmem::find(units, b" since ").is_some()
}

/// Owners of the numbers of a variable.
#[derive(Clone, Copy, PartialEq)]
enum DataLocation {
    Nodes,
    Faces,
}

impl<'h, 'a> Mesh<'h, 'a> {
    /// Visits data of nodes and faces, then the coordinates of faces and edges. Variables with coordinates that stay
    /// unchanged become a remark. Damaged data are skipped, as the mesh does not depend on data.
    pub(super) fn data(&self, tables: &Tables<'h, 'a>, visitor: &mut dyn MeshVisitor) {
        let faces = tables.faces.listed();
        // The order of the faces of a file without a table of faces is unknown, so no variable belongs to such faces.
        let lengths = [self.nodes as u64, faces.map_or(u64::MAX, |faces| faces.count as u64)];
        let places = self.center_variables(tables);
        let is_data = |variable: &&Variable| {
            ![self.x, self.y, self.connectivity.1].iter().any(|own| own.name == variable.name)
                && !places.iter().any(|own| own.variable.name == variable.name)
                && variable.text("cf_role").is_none()
                && !self.is_about_links(variable)
        };
        let mut points = PointData::new(self.header);
        for variable in self.header.variables.iter().filter(is_data) {
            let Some((DataLocation::Nodes, parts)) = self.located(variable, lengths) else {
                continue;
            };
            match visitor.asks_for_data() {
                true => points.send(&variable.name, variable, &parts, variable.missing(), visitor),
                false => {
                    let is_real = matches!(variable.number, NumberType::Real(_));
                    visitor.point_array(&variable.name, parts.components, is_real);
                }
            }
        }
        if let Some(faces) = faces
            && visitor.asks_for_cell_arrays()
        {
            for variable in self.header.variables.iter().filter(is_data) {
                if let Some((DataLocation::Faces, parts)) = self.located(variable, lengths) {
                    self.of_faces(faces, variable, &parts, &mut points, visitor);
                }
            }
        }
        if visitor.asks_for_data() {
            let is_other = |variable: &&Variable| {
                is_data(variable) && self.located(variable, lengths).is_none()
            };
            let others = self.header.variables.iter().filter(is_other);
            self.left_out(others, visitor);
        }
        let left = self.centers(tables, &places, &mut points, visitor);
        if !left.is_empty() {
            let names: Vec<_> = left.iter().map(|own| decoded(&own.name)).collect();
            visitor.remark(Remark::Text(format!(
                "{}: positions of edges or faces, which are not updated",
                names.join(", ")
            )));
        }
    }

    /// Returns whether a variable is about the links of an older net of Delft3D FM.
    fn is_about_links(&self, variable: &Variable) -> bool {
        self.is_of_links() && variable.name.starts_with(LINK)
    }

    /// Returns the owners of a variable's numbers and the layout of its records. `lengths` are the numbers of nodes and
    /// faces. `None` for text, for variables of edges or of another mesh, and if the shape fits neither nodes nor
    /// faces, or both.
    fn located(
        &self,
        variable: &Variable,
        lengths: [u64; 2],
    ) -> Option<(DataLocation, RecordParts)> {
        let is_numeric = matches!(variable.number, NumberType::Real(_) | NumberType::Whole(_));
        if !is_numeric || variable.text("mesh").is_some_and(|mesh| !self.is_own(mesh)) {
            return None;
        }
        let location = match variable.text("location") {
            Some(b"node") => DataLocation::Nodes,
            Some(b"face") => DataLocation::Faces,
            Some(_) => return None,
            None => match lengths.map(|length| variable.shape.contains(&length)) {
                [true, false] => DataLocation::Nodes,
                [false, true] => DataLocation::Faces,
                _ => return None,
            },
        };
        let length = lengths[usize::from(location == DataLocation::Faces)];
        let axis = variable.shape.iter().position(|&own| own == length)?;
        let product = |lengths: &[u64]| {
            lengths.iter().try_fold(1_u64, |product, &n| product.checked_mul(n)).filter(|&n| n > 0)
        };
        let all = usize::try_from(product(&variable.shape[..axis])?).ok()?;
        let components = product(&variable.shape[axis + 1..])?;
        Some((location, RecordParts { wanted: 0..all, all, components }))
    }

    fn of_faces(
        &self,
        faces: &Table<'h, 'a>,
        variable: &'h Variable,
        parts: &RecordParts,
        points: &mut PointData<'h, 'a>,
        visitor: &mut dyn MeshVisitor,
    ) {
        let is_real = matches!(variable.number, NumberType::Real(_));
        let ids = faces.first..faces.first + faces.count as u64;
        for record in 0..self.header.steps(variable) {
            for part in parts.wanted.clone() {
                if visitor.cell_array(&variable.name, parts.components, is_real)
                    && let Some(own) =
                        points.numbers(variable, record, part, parts, variable.missing())
                {
                    variable.packing().into_iter().for_each(|packing| visitor.packing(packing));
                    visitor.cell_numbers(own.numbers, Some(ids.clone().collect()));
                }
            }
        }
    }

    /// Reports content that a conversion loses. `others` are the variables that are neither parts of the mesh nor data of
    /// nodes and faces. Edges, neighbors and coordinates of faces follow from the mesh, and attributes of variables are
    /// comments, so neither is reported.
    fn left_out<'v>(
        &self,
        others: impl Iterator<Item = &'v Variable>,
        visitor: &mut dyn MeshVisitor,
    ) {
        let has = |is_lost: &dyn Fn(&Variable) -> bool| self.header.variables.iter().any(is_lost);
        let is_at = |variable: &Variable, place: &[u8]| variable.text("location") == Some(place);
        let is_of_links =
            |own: &Variable| self.is_about_links(own) && own.name != self.connectivity.1.name;
        if has(&|variable| is_at(variable, b"edge") || is_of_links(variable)) {
            visitor.unsupported("variables of edges");
        }
        if self.connectivity.0 == TableKind::Edges && has(&|variable| is_at(variable, b"face")) {
            visitor.unsupported("variables of faces");
        }
        if [self.x, self.y].iter().any(|axis| axis.packing().is_some()) {
            visitor.unsupported("scale factors and offsets of coordinates");
        }
        let (times, others): (Vec<_>, Vec<_>) = others.partition(|variable| is_time(variable));
        if self.header.records > 1 || !times.is_empty() {
            visitor.unsupported("times of time steps");
        }
        let is_of_mesh = |variable: &Variable| {
            CONNECTIVITIES
                .iter()
                .any(|attribute| self.named(attribute).iter().any(|own| own.name == variable.name))
                || self.is_of_links() && NET_TABLES.contains(&&variable.name[..])
        };
        // A variable without dimensions, such as that of a coordinate system, has its content in attributes.
        let is_scalar = |variable: &Variable| variable.shape.is_empty() && !variable.is_record;
        let is_told = |variable: &Variable| {
            is_at(variable, b"edge")
                || is_at(variable, b"face") && self.connectivity.0 == TableKind::Edges
        };
        let names = others
            .into_iter()
            .filter(|own| !is_of_mesh(own) && !is_scalar(own) && !is_told(own))
            .map(|own| decoded(&own.name));
        let names: Vec<String> = names.collect();
        if !names.is_empty() {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let names = join_first(&names);
            visitor.unsupported(&format!("variables of neither nodes nor faces: {names}"));
        }
    }
}
