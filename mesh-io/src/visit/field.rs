//! Data of a file's vertices, and where the numbers stand in the file.

use crate::edit::column::EditableColumn;
use crate::error::FieldError;
use crate::visit::items::PointNumbers;
use crate::visit::storage::ArrayLocation;

/// Real numbers that a mesh file gives its vertices: depths, third coordinates, point data.
/// [`MeshFile::point_fields`](crate::MeshFile::point_fields) reads them. With new values,
/// [`MeshFile::write_with_fields`](crate::MeshFile::write_with_fields) writes them.
pub struct PointField {
    name: String,
    components: usize,
    /// `components` values for each vertex.
    values: Vec<f64>,
    /// The numbers as they were read, in the order of the file; `new` are those to be written.
    old: Vec<f64>,
    new: Vec<f64>,
    /// The vertex of each tuple of numbers; `None` if there is one for each vertex in order.
    vertices: Option<Vec<u32>>,
    location: Option<ArrayLocation>,
}

impl PointField {
    /// Makes a field from the numbers of an array, in a file of `count` vertices. In `vertices`, a tuple that belongs
    /// to no vertex has an index of no vertex.
    pub(crate) fn new(
        name: String,
        components: usize,
        count: usize,
        PointNumbers { numbers: old, location: stored, .. }: PointNumbers,
        vertices: Option<Vec<u32>>,
    ) -> PointField {
        let values = match &vertices {
            None => old.clone(),
            Some(vertices) => scatter(&old, components, count, vertices.iter().copied()),
        };
        PointField { name, components, values, new: old.clone(), old, vertices, location: stored }
    }

    /// Returns the name in the file: that of an array, `depth` in grids of ADCIRC and SCHISM, or `z` for third
    /// coordinates. Several fields may have the same name, such as the time steps of a result.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns how many numbers each vertex has.
    pub fn components(&self) -> usize {
        self.components
    }

    /// Returns the numbers, vertex by vertex in the order of [`MeshFile::points`](crate::MeshFile::points):
    /// [`components`](Self::components) for each vertex, NaN if the file gives none.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Sets new values, in the order of [`values`](Self::values). If a value is not finite, the file keeps its old
    /// number. A vertex without a number in the file gets none. Returns how many finite numbers were kept because the
    /// new value is not finite.
    ///
    /// # Errors
    /// [`FieldError::ValueCount`] if there are not as many as [`values`](Self::values) has; then nothing is changed.
    pub fn set(&mut self, values: Vec<f64>) -> Result<usize, FieldError> {
        let (expected, given) = (self.values.len(), values.len());
        if expected != given {
            return Err(FieldError::ValueCount { expected, given });
        }
        let mut left = 0;
        let each = self.components.max(1);
        for (tuple, (new, old)) in self.new.chunks_mut(each).zip(self.old.chunks(each)).enumerate()
        {
            let vertex = self.vertices.as_ref().map_or(tuple, |vertices| vertices[tuple] as usize);
            for (component, (new, old)) in new.iter_mut().zip(old).enumerate() {
                let value = values.get(vertex * each + component);
                let precision = self.location.as_ref().map(|stored| stored.encoding.precision());
                let is_finite = |value: &f64| match precision {
                    Some(precision) => precision.rounded(*value).is_finite(),
                    None => value.is_finite(),
                };
                *new = match value.copied().filter(is_finite) {
                    Some(value) => value,
                    None => {
                        left += usize::from(old.is_finite());
                        *old
                    }
                };
            }
        }
        self.values = values;
        Ok(left)
    }

    /// Returns how many numbers the file has.
    pub(crate) fn numbers(&self) -> usize {
        self.old.len()
    }

    /// Returns the location of the numbers in the file; `None` if the numbers cannot be replaced.
    pub(crate) fn location(&self) -> Option<&ArrayLocation> {
        self.location.as_ref()
    }

    /// Whether a number changes, after rounding to the precision of the file.
    pub(crate) fn is_changed(&self) -> bool {
        let Some(stored) = &self.location else { return false };
        let bits = |x: f64| stored.encoding.precision().rounded(x).to_bits();
        self.new.iter().zip(&self.old).any(|(&new, &old)| bits(new) != old.to_bits())
    }

    /// Returns the numbers as a column for rewriting, if they stand in the file.
    pub(crate) fn column(&self) -> Option<EditableColumn<'_>> {
        let ArrayLocation { offsets, encoding, .. } = self.location.as_ref()?;
        Some(EditableColumn::of_array(offsets, *encoding, &self.old, &self.new))
    }
}

/// Returns `components` values for each of `count` vertices: the tuple of numbers whose vertex it is, else NaN. Tuples of
/// vertices that do not exist are left out.
pub(crate) fn scatter(
    numbers: &[f64],
    components: usize,
    count: usize,
    vertices: impl Iterator<Item = u32>,
) -> Vec<f64> {
    let mut values = vec![f64::NAN; count.saturating_mul(components)];
    for (tuple, vertex) in numbers.chunks(components.max(1)).zip(vertices) {
        let start = (vertex as usize).saturating_mul(components);
        if let Some(own) = values.get_mut(start..start.saturating_add(tuple.len())) {
            own.copy_from_slice(tuple);
        }
    }
    values
}

impl std::fmt::Debug for PointField {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PointField")
            .field("name", &self.name)
            .field("components", &self.components)
            .field("numbers", &self.old.len())
            .finish_non_exhaustive()
    }
}
