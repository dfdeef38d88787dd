//! Data of a file's vertices, with the locations of the numbers in the file.

use crate::edit::column::EditableColumn;
use crate::error::FieldError;
use crate::visit::items::PointNumbers;
use crate::visit::storage::ArrayLocation;

/// Field of real numbers on the vertices of a mesh file: depths, third coordinates or point data.
/// [`MeshFile::point_fields`](crate::MeshFile::point_fields) reads fields, and
/// [`MeshFile::write_with_fields`](crate::MeshFile::write_with_fields) writes fields with new values. Fields of
/// [`MeshFile::centers`](crate::MeshFile::centers) hold a number for each face or edge instead.
pub struct PointField {
    name: String,
    components: usize,
    /// `components` values for each vertex.
    values: Vec<f64>,
    /// Numbers as read, in file order; `new` holds the numbers to be written, in equal order.
    old: Vec<f64>,
    new: Vec<f64>,
    /// The vertex of each tuple of numbers; `None` if tuple `i` belongs to vertex `i`.
    vertices: Option<Vec<u32>>,
    location: Option<ArrayLocation>,
    /// Whether the numbers are the third numbers of the points.
    is_third_of_points: bool,
}

impl PointField {
    /// Makes a field from the numbers of an array in a file of `count` vertices. `vertices` holds the vertex of each
    /// tuple; an index of `count` or more marks a tuple without a vertex.
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
        PointField {
            name,
            components,
            values,
            new: old.clone(),
            old,
            vertices,
            location: stored,
            is_third_of_points: false,
        }
    }

    /// Makes the field one of the third numbers of the points.
    pub(crate) fn of_third_numbers(self) -> PointField {
        PointField { is_third_of_points: true, ..self }
    }

    /// Returns the name in the file: the name of an array, `depth` in grids of ADCIRC, SCHISM and FVCOM, or `z` for
    /// third coordinates. The time steps of a result are fields with equal names.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns whether the numbers are the third numbers of the points in the file, and not an array of data: third coordinates,
    /// or heights in the formats that [`has_third_coordinates`](crate::MeshFile::has_third_coordinates) names. Such a field has the
    /// name `z`, as an array of data may have too.
    pub fn is_third_of_points(&self) -> bool {
        self.is_third_of_points
    }

    /// Returns the number of components per vertex, 1 for scalars.
    pub fn components(&self) -> usize {
        self.components
    }

    /// Returns the values in the order of [`MeshFile::points`](crate::MeshFile::points),
    /// [`components`](Self::components) for each vertex. Vertices without numbers in the file have NaN.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Sets new values, in the order of [`values`](Self::values). If a value is not finite after rounding to the file's
    /// precision, the file keeps its old number. Values of vertices without numbers in the file are not written.
    /// Returns how many infinite or NaN values are replaced by finite old numbers.
    ///
    /// # Errors
    /// [`FieldError::ValueCount`] if the length differs from the length of [`values`](Self::values). The field is then
    /// unchanged.
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

    /// Returns whether a rewrite can replace the numbers. Numbers that some vertices lack cannot be replaced.
    pub fn is_replaceable(&self) -> bool {
        self.location.is_some()
    }

    /// Returns the number of values stored in the file.
    pub(crate) fn numbers(&self) -> usize {
        self.old.len()
    }

    /// Returns the location of the numbers in the file; `None` if the numbers cannot be replaced.
    pub(crate) fn location(&self) -> Option<&ArrayLocation> {
        self.location.as_ref()
    }

    /// Returns whether a number changes after rounding to the file's precision; false if the numbers cannot be
    /// replaced.
    pub(crate) fn is_changed(&self) -> bool {
        let Some(stored) = &self.location else { return false };
        let bits = |x: f64| stored.encoding.precision().rounded(x).to_bits();
        self.new.iter().zip(&self.old).any(|(&new, &old)| bits(new) != old.to_bits())
    }

    /// Returns whether `other` is an array of the same bytes, type and new numbers.
    pub(crate) fn is_copy_of(&self, other: &PointField) -> bool {
        let (Some(own), Some(stored)) = (&self.location, &other.location) else { return false };
        let (Some(bytes), Some(shared)) = (&own.shared, &stored.shared) else { return false };
        let bits = |field: &PointField| field.new.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        own.file_index == stored.file_index
            && bytes.range == shared.range
            && own.encoding == stored.encoding
            && bits(self) == bits(other)
    }

    /// Returns old and new numbers as a column for a rewrite; `None` if the numbers cannot be replaced.
    pub(crate) fn column(&self) -> Option<EditableColumn<'_>> {
        let ArrayLocation { offsets, encoding, .. } = self.location.as_ref()?;
        Some(EditableColumn::of_array(offsets, *encoding, &self.old, &self.new))
    }
}

/// Returns whether an array of `components` values for each of `count` vertices or cells may be made from `numbers`
/// numbers of a file. A damaged file may announce any number of components, so the array may exceed the numbers only by
/// tuples of usual length.
pub(crate) fn has_room(numbers: usize, components: usize, count: usize) -> bool {
    /// Limit on the components of an array that lacks values for some vertices or cells. The arrays of results have
    /// 9 components at most, and those of histories and spectra up to some hundred.
    const MAX_SPARSE_COMPONENTS: usize = 256;
    count
        .checked_mul(components)
        .is_some_and(|values| components <= MAX_SPARSE_COMPONENTS || values <= numbers)
}

/// Returns `components` values for each of `count` vertices: the vertex's tuple in `numbers`, or NaN for vertices
/// without a tuple. Tuples with vertex indices of `count` or more are dropped. Returns `numbers` unchanged, which then
/// are fewer than `count * components`, if [`has_room`] does not hold.
pub(crate) fn scatter(
    numbers: &[f64],
    components: usize,
    count: usize,
    vertices: impl Iterator<Item = u32>,
) -> Vec<f64> {
    if !has_room(numbers.len(), components, count) {
        return numbers.to_vec();
    }
    let mut values = vec![f64::NAN; count * components];
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
