//! Data of the vertices of a mesh file, by name.

use crate::content::group::distance;
use crate::error::ReadError;
use crate::mesh_file::mesh::MeshFile;
use crate::text::token::quoted;
use crate::visit::field::PointField;
use crate::visit::point_data;
use crate::visit::point_data::{FieldSelection, PointData};

impl MeshFile {
    /// Reads arrays of real numbers on vertices: arrays with the given names, or all arrays for `None`. The bytes of
    /// the file are parsed again.
    ///
    /// Third coordinates are named `z`, depths of ADCIRC, SCHISM and FVCOM `depth`. Other arrays keep their names in
    /// the file. The table of data of vertices in `docs/formats.md` of the repository lists the names for each format.
    ///
    /// Each array is one field. The time steps of a result are fields with equal names.
    ///
    /// # Errors
    /// [`ReadError`] if a name belongs to no array or to an array of whole numbers, or if an array is damaged.
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
        // Checks `fields` instead of `known`: an array of whole numbers may precede an array of real numbers with an
        // equal name.
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
    /// properties of PLY's vertices, and all arrays that [`point_fields`](Self::point_fields) reads. Of data and third coordinates
    /// that both have the name `z`, reads the data.
    ///
    /// # Errors
    /// [`ReadError`] if no array has the name, if the array is damaged, or if its numbers are not one per vertex.
    pub fn point_array(&self, name: &str) -> Result<Vec<f64>, ReadError> {
        let source = self.source();
        let PointData { fields, known } =
            self.data_of(FieldSelection::Named(&[name.to_owned()]))?;
        let vertices = self.points().len();
        let shown = quoted(name.as_bytes());
        // Third coordinates have the name of data that are named z.
        let data = fields.iter().find(|field| !field.is_third_of_points()).or(fields.first());
        match data.map(|field| (field.components(), field.values())) {
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
