//! Centers of faces and edges, which UGRID files may store.

use crate::content::id_index::IdIndex;
use crate::error::FieldError;
use crate::mesh_file::mesh::MeshFile;
use crate::text::cursor::Cursor;
use crate::visit::field::PointField;
use crate::visit::items::Centers;
use crate::visit::visitor::MeshVisitor;

/// Relative tolerance for recognizing a stored center, in units of the distance between the computed center and the
/// farthest corner along the axis.
const CENTER_TOLERANCE: f64 = 1e-6;

/// Function from the corners of an element to its center; `None` if the corners have no such center.
type CenterFunction = fn(&[[f64; 2]]) -> Option<[f64; 2]>;

/// Functions for the centers that programs store, in the order in which arrays are tested.
const CENTER_FUNCTIONS: [CenterFunction; 3] = [mean, centroid, circumcenter];

/// Array in the file with one coordinate of the centers of elements.
struct Array {
    name: String,
    axis: usize,
    centers: Centers,
}

impl MeshFile {
    /// Returns the stored centers of faces and edges, updated for vertices at `points`, as fields for
    /// [`write_with_fields`](Self::write_with_fields). A field has one coordinate of the centers, with a number per
    /// face or edge. An array is updated if all its numbers are means of corners, all are centroids, or all are
    /// circumcenters of triangles. The second list holds the names of the remaining arrays. Without centers in the
    /// file, both lists are empty.
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
                elements.moved(&centers.numbers.numbers, axis, [old, points], error)
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

    /// Returns the numbers for the new positions of vertices; elements without a moved vertex keep their numbers.
    /// `None` if no center function reproduces all numbers from the old positions. `error` bounds the rounding error of
    /// numbers of a size.
    fn moved(
        &self,
        numbers: &[f64],
        axis: usize,
        [old, new]: [&[[f64; 2]]; 2],
        error: impl Fn(f64) -> f64,
    ) -> Option<Vec<f64>> {
        let mut corners = Vec::new();
        let mut at = |points: &[[f64; 2]], element: &[u32], recipe: CenterFunction| {
            corners.clear();
            corners.extend(element.iter().map(|&vertex| points[vertex as usize]));
            let center = recipe(&corners)?[axis];
            let far = corners.iter().map(|corner| (corner[axis] - center).abs());
            Some((center, far.fold(0.0, f64::max)))
        };
        let mut fits = |recipe: CenterFunction| {
            self.each().zip(numbers).filter(|(element, _)| !element.is_empty()).all(
                |(element, &number)| {
                    let found = at(old, element, recipe);
                    found.is_some_and(|(center, reach)| {
                        (center - number).abs()
                            <= CENTER_TOLERANCE * reach + 4.0 * error(center.abs())
                    })
                },
            )
        };
        let recipe = CENTER_FUNCTIONS.into_iter().find(|&recipe| fits(recipe))?;
        let updated = self.each().zip(numbers).map(|(element, &number)| {
            let has_moved =
                |&v: &u32| old[v as usize].map(f64::to_bits) != new[v as usize].map(f64::to_bits);
            match element.iter().any(has_moved) {
                true => at(new, element, recipe).map_or(number, |(center, _)| center),
                false => number,
            }
        });
        Some(updated.collect())
    }
}

fn mean(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let &first = corners.first()?;
    // Sums differences to the first corner, which loses no digits far from the origin.
    let offset = |axis: usize| corners.iter().map(|corner| corner[axis] - first[axis]).sum::<f64>();
    Some([0, 1].map(|axis| first[axis] + offset(axis) / corners.len() as f64))
}

/// Returns the center of mass of a polygon; `None` for zero area.
fn centroid(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let &[first, ref others @ ..] = corners else { return None };
    let (mut area, mut moment) = (0.0, [0.0; 2]);
    for pair in others.windows(2) {
        let [b, c] = [0, 1].map(|k| [pair[k][0] - first[0], pair[k][1] - first[1]]);
        let doubled = b[0] * c[1] - b[1] * c[0];
        area += doubled;
        moment = [0, 1].map(|axis| moment[axis] + doubled * (b[axis] + c[axis]) / 3.0);
    }
    (area != 0.0).then(|| [0, 1].map(|axis| first[axis] + moment[axis] / area))
}

fn circumcenter(corners: &[[f64; 2]]) -> Option<[f64; 2]> {
    let &[a, b, c] = corners else { return None };
    let [b, c] = [b, c].map(|corner| [corner[0] - a[0], corner[1] - a[1]]);
    let doubled = 2.0 * (b[0] * c[1] - b[1] * c[0]);
    let [bb, cc] = [b, c].map(|[x, y]| x * x + y * y);
    let offset = [(c[1] * bb - b[1] * cc) / doubled, (b[0] * cc - c[0] * bb) / doubled];
    (doubled != 0.0).then(|| [a[0] + offset[0], a[1] + offset[1]])
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
        self.last = (String::from_utf8_lossy(name).into_owned(), axis);
        true
    }

    fn center_numbers(&mut self, centers: Centers) {
        let (name, axis) = std::mem::take(&mut self.last);
        self.found.push(Array { name, axis, centers });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn centers_of_triangles_and_quadrilaterals() {
        let triangle = [[1e6, 0.0], [1e6 + 4.0, 0.0], [1e6, 3.0]];
        assert_eq!(mean(&triangle), Some([1e6 + 4.0 / 3.0, 1.0]));
        assert_eq!(circumcenter(&triangle), Some([1e6 + 2.0, 1.5]));
        let close = |a: [f64; 2], b: [f64; 2]| (0..2).all(|k| (a[k] - b[k]).abs() < 1e-9);
        assert!(close(centroid(&triangle).unwrap(), mean(&triangle).unwrap()));
        let trapezoid = [[0.0, 0.0], [6.0, 0.0], [3.0, 3.0], [0.0, 3.0]];
        assert!(close(centroid(&trapezoid).unwrap(), [7.0 / 3.0, 4.0 / 3.0]));
        assert_eq!(mean(&trapezoid), Some([2.25, 1.5]));
        assert_eq!(circumcenter(&trapezoid), None);
        assert_eq!(circumcenter(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]), None);
        assert_eq!((mean(&[]), centroid(&[[1.0, 2.0]])), (None, None));
    }
}
