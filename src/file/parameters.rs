//! Parameters of vertices on surfaces of a model, as gmsh's files may have them.

use crate::error::MeshError;
use crate::file::families::Family;
use crate::file::field::PointField;
use crate::file::mesh_file::MeshFile;
use crate::file::parametric;

/// How far parameters may be from those of a plane, as a share of how far they reach.
const FLAT: f64 = 1e-8;

impl MeshFile {
    /// The parameters that the file gives vertices on surfaces of a model, brought up to date for vertices at `points`, as
    /// fields for [`write_with`](Self::write_with). Only those of plane surfaces can be: there u and v are linear in x and
    /// y. Returns them, and on how many other surfaces there are parameters.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex. Without parameters there is nothing to return.
    pub fn plane_parameters(
        &self,
        points: &[[f64; 2]],
    ) -> Result<(Vec<PointField>, usize), MeshError> {
        let old = &self.mesh().points;
        if points.len() != old.len() {
            return Err(MeshError::PointCount { expected: old.len(), given: points.len() });
        }
        let reader = Family::of(self.format()).reader.as_ref().filter(|_| self.has_parameters());
        // What was read once can be read again.
        let fields =
            reader.and_then(|reader| parametric::parameters(reader, &self.sources()[0]).ok());
        let (mut plane, mut others) = (Vec::new(), 0);
        for mut field in fields.unwrap_or_default() {
            let Some(slopes) = slopes(old, field.values()) else {
                others += 1;
                continue;
            };
            let pairs = field.values().as_chunks::<2>().0.iter().zip(old.iter().zip(points));
            let moved = pairs.flat_map(|(parameters, (old, new))| {
                let by = [new[0] - old[0], new[1] - old[1]];
                // A vertex that has not moved keeps its numbers to the bit.
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

/// x and y of a vertex, and its u and v.
type Pair = ([f64; 2], [f64; 2]);

/// How u and v grow with x and y, if they are linear in these for all vertices that have them: by least squares.
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
    // Not so for NaN, of which the slopes are where all vertices are on a line.
    let is_linear = centered().all(|([x, y], own)| {
        let far = |k: usize| (slopes[k][0] * x + slopes[k][1] * y - own[k]).abs();
        far(0) <= FLAT * reach && far(1) <= FLAT * reach
    });
    (given.len() >= 3 && is_linear).then_some(slopes)
}
