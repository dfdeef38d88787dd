//! Centers of faces and edges, which UGRID files may store.

use crate::content::decoded::decoded;
use crate::content::id_index::IdIndex;
use crate::content::remark::Remark;
use crate::error::FieldError;
use crate::mesh_file::center_functions::{CenterCoordinate, CenterFunction, within};
use crate::mesh_file::mesh::MeshFile;
use crate::text::cursor::Cursor;
use crate::visit::field::PointField;
use crate::visit::items::Centers;
use crate::visit::visitor::MeshVisitor;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Relative tolerance for recognizing a stored center, in units of the distance between the computed center and the
/// farthest corner along the axis.
const CENTER_TOLERANCE: f64 = 1e-6;

/// Array in the file with one coordinate of the centers of elements.
struct Array {
    name: String,
    axis: usize,
    centers: Centers,
}

impl MeshFile {
    /// Returns the stored centers of faces and edges, updated for vertices at `points`, as fields for
    /// [`write_with_fields`](Self::write_with_fields). A field has one coordinate of the centers, with a number per
    /// face or edge. An array is updated if all numbers of triangles are means of corners, all are centroids, or all are
    /// circumcenters, also those of Delft3D FM, which never leave their triangle. The numbers of edges, and of faces with
    /// more corners, must be of one kind too unless no vertex of such an element has moved. If the file says that coordinates are in degrees, corners are continued across the
    /// date line, and centers on the sphere are recognized too. The second list holds the names of the remaining arrays.
    /// Without centers in the file, both lists are empty.
    ///
    /// # Errors
    /// [`FieldError::PointCount`] if `points` does not have exactly one point per vertex.
    pub fn centers(
        &self,
        points: &[[f64; 2]],
    ) -> Result<(Vec<PointField>, Vec<String>), FieldError> {
        let old = self.points();
        if points.len() != old.len() {
            return Err(FieldError::PointCount { expected: old.len(), given: points.len() });
        }
        let mut visitor = CenterVisitor::default();
        if self.has_centers() {
            // A second reading of the bytes cannot fail, as the first reading had no error.
            _ = (self.reader().visit)(self.source(), &mut visitor);
        }
        let map = IdIndex::new(&visitor.ids).unwrap_or(IdIndex::Run { first: 0, count: 0 });
        let (mut fields, mut others) = (Vec::new(), Vec::new());
        for Array { name, axis, centers } in visitor.found {
            let new = Elements::of(&centers, &map).and_then(|elements| {
                let stored = centers.numbers.location.as_ref()?.encoding.precision();
                let error = |size: f64| stored.error(size).max(self.precision().error(size));
                let coordinate = CenterCoordinate {
                    axis,
                    is_in_degrees: self.remarks().contains(&Remark::Degrees),
                };
                elements.moved(&centers.numbers.numbers, coordinate, [old, points], error)
            });
            match new {
                None => others.push(name),
                Some(new) => {
                    let count = new.len();
                    let mut field = PointField::new(name, 1, count, centers.numbers, None);
                    field.set(new)?;
                    fields.push(field);
                }
            }
        }
        Ok((fields, others))
    }
}

/// Vertices of the elements of an array of centers.
struct Elements<'c> {
    vertices: Vec<u32>,
    ends: &'c [usize],
}

impl<'c> Elements<'c> {
    /// Looks up the vertices of elements. `None` for an unknown node id, or unless there is one number per element.
    fn of(centers: &'c Centers, map: &IdIndex) -> Option<Elements<'c>> {
        let vertices = centers.nodes.iter().map(|&node| map.index(node)).collect::<Option<_>>()?;
        (centers.ends.len() == centers.numbers.numbers.len())
            .then_some(Elements { vertices, ends: &centers.ends })
    }

    fn each(&self) -> impl Iterator<Item = &[u32]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(self.ends).map(|(start, &end)| &self.vertices[start..end])
    }

    /// Returns the numbers for the new positions of vertices; elements without a moved vertex keep their numbers. A center
    /// function is found for each number of corners of which an element has a moved vertex. `None` if no function
    /// reproduces all numbers of such elements from the old positions. `error` bounds the rounding error of numbers of a
    /// size.
    fn moved(
        &self,
        numbers: &[f64],
        coordinate: CenterCoordinate,
        [old, new]: [&[[f64; 2]]; 2],
        error: impl Fn(f64) -> f64,
    ) -> Option<Vec<f64>> {
        let mut corners = Vec::new();
        let mut at = |points: &[[f64; 2]], element: &[u32], function: CenterFunction| {
            corners.clear();
            corners.extend(element.iter().map(|&vertex| points[vertex as usize]));
            let center = function(&corners)?[coordinate.axis];
            let far = corners.iter().map(|corner| (corner[coordinate.axis] - center).abs());
            Some((center, far.fold(0.0, f64::max)))
        };
        let mut fits = |function: CenterFunction, count: usize| {
            self.each().zip(numbers).filter(|(element, _)| element.len() == count).all(
                |(element, &number)| {
                    let found = at(old, element, function);
                    found.is_some_and(|(center, reach)| {
                        (coordinate.near(center, number) - number).abs()
                            <= CENTER_TOLERANCE * reach + 4.0 * error(center.abs())
                    })
                },
            )
        };
        let has_moved =
            |&v: &u32| old[v as usize].map(f64::to_bits) != new[v as usize].map(f64::to_bits);
        // The function for each number of corners.
        let mut functions: HashMap<usize, CenterFunction> = HashMap::new();
        for element in self.each().filter(|element| element.iter().any(has_moved)) {
            if let Entry::Vacant(entry) = functions.entry(element.len()) {
                let mut all = coordinate.functions().iter().copied();
                entry.insert(all.find(|&function| fits(function, element.len()))?);
            }
        }
        let range = coordinate.range(numbers);
        let updated = self.each().zip(numbers).map(|(element, &number)| {
            let function = functions.get(&element.len());
            let function = function.filter(|_| element.iter().any(has_moved));
            let center = function.and_then(|&function| at(new, element, function));
            center.map_or(number, |(center, _)| within(&range, coordinate.near(center, number)))
        });
        Some(updated.collect())
    }
}

/// Visitor that collects arrays with the centers of elements.
#[derive(Default)]
struct CenterVisitor {
    ids: Vec<u64>,
    last: (String, usize),
    found: Vec<Array>,
}

impl MeshVisitor for CenterVisitor {
    fn allows_parallel(&self) -> bool {
        true
    }

    fn node(&mut self, _: &Cursor<'_>, id: u64, _: u64, _: usize, _: [f64; 2]) {
        self.ids.push(id);
    }

    fn center_array(&mut self, name: &[u8], axis: usize) -> bool {
        self.last = (decoded(name), axis);
        true
    }

    fn center_numbers(&mut self, centers: Centers) {
        let (name, axis) = std::mem::take(&mut self.last);
        self.found.push(Array { name, axis, centers });
    }
}
