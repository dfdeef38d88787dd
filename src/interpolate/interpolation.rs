//! Interpolates the data of vertices that have moved.

use super::locate::{Found, Locator};
use crate::error::MeshError;
use crate::parallel::map_ranges;
use crate::topology::Topology;

/// The positions of moved vertices within the old mesh, found once for any number of data.
///
/// Data of vertices, such as depths or a solution, no longer fit where vertices have moved. This takes them from the
/// old mesh at the new positions, linearly in each triangle. A vertex that has not moved keeps its data to the bit.
/// Data that are linear over the mesh stay so up to rounding. No value is above or below those of the triangle from
/// which it is taken.
///
/// ```
/// use gpu_smooth::{interpolate::Interpolation, Mesh, Topology};
///
/// let mesh = Mesh {
///     points: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.5, 1.0]],
///     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
///     fixed: vec![],
/// };
/// let mut moved = mesh.points.clone();
/// moved[4] = [1.0, 1.0];
/// let topology = Topology::new(&mesh)?;
/// let interpolation = Interpolation::new(&topology, &mesh.points, &moved)?;
/// let depths = [0.0, 2.0, 2.0, 0.0, 1.5];
/// assert_eq!(interpolation.apply(&depths, 1)?, [0.0, 2.0, 2.0, 0.0, 1.0]);
/// # Ok::<(), gpu_smooth::MeshError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Interpolation {
    vertices: usize,
    /// Each vertex that has moved, ascending, and where it is in the old mesh.
    moved: Vec<(u32, Found)>,
}

impl Interpolation {
    /// Finds the new positions of vertices in the old mesh, on all cores. The search starts from the vertex's own
    /// triangles and crosses edges that triangles share, so that overlapping parts of a mesh are told apart. Exact
    /// predicates find the triangle that holds a position. A position outside of the mesh counts as the nearest point
    /// of the triangles that were searched, up to 20,000.
    ///
    /// `old` and `new` have one point for each vertex, in any unit.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex, [`MeshError::NotFinite`] for a new point
    /// that is not finite, [`MeshError::Infeasible`] if the old mesh has inverted or flat triangles: several triangles
    /// may then hold a position.
    pub fn new(
        topology: &Topology<'_>,
        old: &[[f64; 2]],
        new: &[[f64; 2]],
    ) -> Result<Interpolation, MeshError> {
        let triangles = topology.bad_triangles(old)?;
        topology.check_count(new)?;
        if !triangles.is_empty() {
            return Err(MeshError::Infeasible { triangles });
        }
        if let Some(vertex) = new.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            return Err(MeshError::NotFinite { vertex: vertex as u32 });
        }
        let locator = Locator { topology, points: old };
        let moved = map_ranges(new.len(), 1 << 10, |range| {
            let moved = range.filter(|&vertex| old[vertex] != new[vertex]);
            let found = moved.filter_map(|vertex| {
                let found = locator.find(vertex as u32, new[vertex])?;
                Some((vertex as u32, found))
            });
            found.collect::<Vec<_>>()
        });
        Ok(Interpolation { vertices: new.len(), moved: moved.concat() })
    }

    /// Number of vertices that have moved.
    pub fn moved(&self) -> usize {
        self.moved.len()
    }

    /// Returns the data at the new positions. `values` has `components` numbers for each vertex, and so has the result.
    /// A number that is not finite makes those computed from it NaN.
    ///
    /// # Errors
    /// [`MeshError::ValueCount`] if `values` does not have `components` numbers for each vertex.
    pub fn apply(&self, values: &[f64], components: usize) -> Result<Vec<f64>, MeshError> {
        let expected = self.vertices.saturating_mul(components);
        if values.len() != expected {
            return Err(MeshError::ValueCount { expected, given: values.len() });
        }
        let mut out = values.to_vec();
        let taken = map_ranges(self.moved.len(), 1 << 12, |range| {
            let taken = self.moved[range].iter().flat_map(|(_, found)| {
                let at = |vertex: u32, component| values[vertex as usize * components + component];
                (0..components).map(move |component| {
                    linear(found.corners.map(|vertex| at(vertex, component)), found.weights)
                })
            });
            taken.collect::<Vec<_>>()
        });
        let mut taken = taken.into_iter().flatten();
        for &(vertex, _) in &self.moved {
            let own = &mut out[vertex as usize * components..][..components];
            own.iter_mut().zip(&mut taken).for_each(|(own, value)| *own = value);
        }
        Ok(out)
    }
}

/// Interpolates linearly between three values. If they are equal, the result is the same to the bit.
pub(super) fn linear([a, b, c]: [f64; 3], [to_b, to_c]: [f64; 2]) -> f64 {
    if ![a, b, c].iter().all(|value| value.is_finite()) {
        return f64::NAN;
    }
    // Uses halves, as a difference of two large numbers may overflow.
    let value = a + 2.0 * (to_b * (0.5 * b - 0.5 * a) + to_c * (0.5 * c - 0.5 * a));
    value.clamp(a.min(b).min(c), a.max(b).max(c))
}
