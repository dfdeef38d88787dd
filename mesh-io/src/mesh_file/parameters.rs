//! Parameters of vertices on surfaces of a model, which gmsh files may store.

use crate::error::FieldError;
use crate::mesh_file::mesh::MeshFile;
use crate::mesh_file::parametric;
use crate::visit::field::PointField;

/// Largest deviation of parameters from a linear function of x and y on a plane, relative to the range of the
/// parameters.
const PLANE_TOLERANCE: f64 = 1e-8;

impl MeshFile {
    /// Returns the parameters of vertices on plane surfaces of a model, updated for vertices that move from `old` to
    /// `new`, as fields for [`write_with_fields`](Self::write_with_fields). Positions are coordinates in the plane of
    /// the mesh: [`points`](Self::points) in the plane of x and y. On a plane, u and v are linear in these coordinates.
    /// The second result counts other surfaces with parameters, which cannot be updated. A file without parameters
    /// returns an empty list and 0.
    ///
    /// # Errors
    /// [`FieldError::PointCount`] if `old` or `new` does not have exactly one point per vertex.
    pub fn plane_parameters(
        &self,
        old: &[[f64; 2]],
        new: &[[f64; 2]],
    ) -> Result<(Vec<PointField>, usize), FieldError> {
        let expected = self.points().len();
        if let Some(given) = [old.len(), new.len()].into_iter().find(|&given| given != expected) {
            return Err(FieldError::PointCount { expected, given });
        }
        // A second reading of the bytes cannot fail, as the first reading had no error.
        let read = || parametric::parameters(self.reader(), self.source()).ok();
        let fields = self.has_parameters().then(read).flatten();
        let (mut plane, mut others) = (Vec::new(), 0);
        for mut field in fields.unwrap_or_default() {
            let Some(slopes) = slopes(old, field.values()) else {
                others += 1;
                continue;
            };
            let pairs = field.values().as_chunks::<2>().0.iter().zip(old.iter().zip(new));
            let moved = pairs.flat_map(|(parameters, (old, new))| {
                let by = [new[0] - old[0], new[1] - old[1]];
                // A vertex that has not moved keeps the bits of its parameters.
                [0, 1].map(|k| match by {
                    [0.0, 0.0] => parameters[k],
                    [x, y] => parameters[k] + slopes[k][0] * x + slopes[k][1] * y,
                })
            });
            let moved = moved.collect();
            field.set(moved)?;
            plane.push(field);
        }
        Ok((plane, others))
    }
}

/// x and y of a vertex, and its parameters u and v.
type Pair = ([f64; 2], [f64; 2]);

/// Returns the slopes of u and v in x and y, by least squares. `None` unless u and v are linear over all vertices with
/// parameters, three or more.
fn slopes(points: &[[f64; 2]], parameters: &[f64]) -> Option<[[f64; 2]; 2]> {
    let pairs = points.iter().zip(parameters.as_chunks::<2>().0);
    let given: Vec<Pair> = pairs
        .filter(|(_, parameters)| parameters.iter().all(|x| x.is_finite()))
        .map(|(&point, &parameters)| (point, parameters))
        .collect();
    let mean = |of: fn(&Pair) -> [f64; 2]| {
        let sum = given.iter().map(of).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]);
        sum.map(|sum| sum / given.len() as f64)
    };
    let (point, parameter) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let centered = || {
        given.iter().map(move |(at, own)| {
            let at = [at[0] - point[0], at[1] - point[1]];
            (at, [own[0] - parameter[0], own[1] - parameter[1]])
        })
    };
    let (mut xx, mut xy, mut yy, mut right) = (0.0, 0.0, 0.0, [[0.0; 2]; 2]);
    for ([x, y], own) in centered() {
        (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
        for (right, own) in right.iter_mut().zip(own) {
            *right = [right[0] + x * own, right[1] + y * own];
        }
    }
    let determinant = xx * yy - xy * xy;
    let slopes =
        right.map(|[x, y]| [(x * yy - y * xy) / determinant, (y * xx - x * xy) / determinant]);
    let reach = centered().flat_map(|(_, own)| own).fold(0.0, |a: f64, b| a.max(b.abs()));
    // If all vertices lie on a line, the slopes are NaN and the comparison fails.
    let is_linear = centered().all(|([x, y], own)| {
        let far = |k: usize| (slopes[k][0] * x + slopes[k][1] * y - own[k]).abs();
        far(0) <= PLANE_TOLERANCE * reach && far(1) <= PLANE_TOLERANCE * reach
    });
    (given.len() >= 3 && is_linear).then_some(slopes)
}
