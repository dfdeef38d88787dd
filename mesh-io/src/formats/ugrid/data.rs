//! Node and face data of a UGRID file.

use super::centers::Tables;
use super::kind::TableKind;
use super::mesh::Mesh;
use super::table::Table;
use crate::content::remark::Remark;
use crate::formats::netcdf_points::{PointData, RecordParts};
use crate::netcdf::{NumberType, Variable};
use crate::visit::visitor::MeshVisitor;

/// Start of the names of the variables of edges in older nets of Delft3D FM.
const LINK: &[u8] = b"NetLink";

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
            self.left_out(visitor);
        }
        let left = self.centers(tables, &places, &mut points, visitor);
        if !left.is_empty() {
            let names: Vec<_> = left.iter().map(|own| String::from_utf8_lossy(&own.name)).collect();
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
        let is_own = |mesh| self.own.is_some_and(|own| own.name == mesh);
        if !is_numeric || variable.text("mesh").is_some_and(|mesh| !is_own(mesh)) {
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
                    visitor.cell_numbers(own.numbers, Some(ids.clone().collect()));
                }
            }
        }
    }

    /// Reports content that a conversion loses. Edges, neighbors and coordinates of faces follow from the mesh, and
    /// attributes of variables are comments, so neither is reported.
    fn left_out(&self, visitor: &mut dyn MeshVisitor) {
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
        if self.header.records > 1 {
            visitor.unsupported("times of time steps");
        }
    }
}
