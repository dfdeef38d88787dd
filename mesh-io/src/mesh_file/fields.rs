//! Data of the vertices of a mesh file, by name.

use crate::content::group::distance;
use crate::error::ReadError;
use crate::mesh_file::mesh::MeshFile;
use crate::text::token::quoted;
use crate::visit::field::PointField;
use crate::visit::point_data;
use crate::visit::point_data::{FieldSelection, PointData};

impl MeshFile {
    /// Reads the real numbers that the file gives its vertices under these names, or all real numbers for `None`. The
    /// file's content is searched again for them.
    ///
    /// Third coordinates are named `z`, and those of ADCIRC, SCHISM and FVCOM `depth`. Other data have the names that the file
    /// gives them. The table of data of vertices in `docs/formats.md` of the repository has the names of each format.
    ///
    /// Each array is one field. Several fields may have the same name, such as the time steps of a result.
    ///
    /// # Errors
    /// [`ReadError`] if no data have one of the names, if their numbers are whole, or if they are damaged.
    pub fn point_fields(&self, names: Option<&[String]>) -> Result<Vec<PointField>, ReadError> {
        let PointData { fields, known } =
            self.data_of(names.map_or(FieldSelection::Real, FieldSelection::Named))?;
        let source = self.source();
        for name in names.unwrap_or_default() {
            let shown = quoted(name.as_bytes());
            match known.iter().find(|(known, _)| known == name) {
                None => {
                    let real = known.iter().filter(|(_, is_real)| *is_real);
                    return Err(self.unknown(name, real.map(|(name, _)| name.clone()).collect()));
                }
                Some((_, false)) => {
                    let problem = format!("'{shown}' holds whole numbers");
                    let remedy = "Only real numbers can be interpolated";
                    return Err(source.error(problem, remedy));
                }
                Some((_, true)) => {}
            }
        }
        let vertices = self.points().len();
        for (name, _) in known.iter().filter(|(_, is_real)| *is_real) {
            let is_wanted = names.is_none_or(|names| names.contains(name));
            if is_wanted && !fields.iter().any(|field| field.name() == name) {
                return Err(self.damaged(name));
            }
        }
        // Whole numbers may come first under a name that real ones have too.
        for field in &fields {
            let (found, each) = (field.values().len(), field.components());
            if Some(found) != vertices.checked_mul(each) {
                let name = quoted(field.name().as_bytes());
                let problem = format!("'{name}' has {found} numbers, {each} per vertex");
                return Err(source.error(problem, format!("There are {vertices} vertices")));
            }
        }
        Ok(fields)
    }

    /// Reads an array of point data with one number for each vertex, real or whole: scalars of VTK's formats,
    /// properties of PLY's vertices, and all data that [`point_fields`](Self::point_fields) finds.
    ///
    /// # Errors
    /// [`ReadError`] if there is no such array, if its data are damaged, or if it does not have one number for each
    /// vertex.
    pub fn point_array(&self, name: &str) -> Result<Vec<f64>, ReadError> {
        let source = self.source();
        let PointData { fields, known } =
            self.data_of(FieldSelection::Named(&[name.to_owned()]))?;
        let vertices = self.points().len();
        let shown = quoted(name.as_bytes());
        match fields.first().map(|field| (field.components(), field.values())) {
            Some((1, values)) if values.len() == vertices => Ok(values.to_vec()),
            Some((1, values)) => {
                let problem = format!("the array '{shown}' has {} numbers", values.len());
                Err(source.error(problem, format!("There are {vertices} vertices")))
            }
            Some((components, _)) => {
                let problem = format!("the array '{shown}' has {components} numbers per point");
                Err(source.error(problem, "Take an array with one number per point"))
            }
            None if known.iter().any(|(known, _)| known == name) => Err(self.damaged(name)),
            None => Err(self.unknown(name, known.into_iter().map(|(name, _)| name).collect())),
        }
    }

    fn data_of(&self, wanted: FieldSelection<'_>) -> Result<PointData, ReadError> {
        point_data::point_data(self.reader(), self.source(), wanted)
    }

    fn damaged(&self, name: &str) -> ReadError {
        let problem = format!("the array '{}' is damaged or cut off", quoted(name.as_bytes()));
        self.source().error(problem, "Write the mesh again")
    }

    fn unknown(&self, name: &str, mut known: Vec<String>) -> ReadError {
        known.sort_by_cached_key(|own| distance(own, name));
        let problem = format!("no point data is called '{}'", quoted(name.as_bytes()));
        let remedy = match &known[..] {
            [] => "The file has no point data".to_owned(),
            _ => format!("There are {}", known.join(", ")),
        };
        self.source().error(problem, remedy)
    }
}
