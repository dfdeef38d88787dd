//! Interpolation of vertex data after vertices have moved.

use super::element::LocatedPoint;
use super::locate::Locator;
use crate::error::MeshError;
use crate::parallel::map_ranges;
use crate::topology::Topology;

/// Moved vertices located in the old mesh, once for any number of data.
///
/// Vertex data, such as depths or a solution, no longer fit where vertices have moved. An interpolation evaluates the
/// data of the old mesh at the new positions, linearly in each triangle and bilinearly in each quadrilateral. A vertex that has
/// not moved keeps the bits of its data. Data that are linear over the mesh remain linear up to rounding. Every interpolated value
/// is bounded by the values at the corners of its element.
///
/// ```
/// use gpu_smooth::{interpolate::Interpolation, Mesh, Topology};
///
/// let mesh = Mesh {
///     points: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.5, 1.0]],
///     triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
///     fixed: vec![],
///     ..Mesh::default()
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
    /// Each moved vertex, ascending, with its location in the old mesh.
    moved: Vec<(u32, LocatedPoint)>,
}

impl Interpolation {
    /// Locates the new positions of vertices in the old mesh, on all cores. The search starts from the elements of the
    /// vertex and crosses shared edges, so it tells overlapping parts of a mesh apart. Exact predicates decide which
    /// element contains a position. A position outside of the mesh is replaced by the nearest point of the elements
    /// that were searched, up to 20,000.
    ///
    /// `old` and `new` have one point per vertex, in any unit.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `old` or `new` does not have one entry per vertex, [`MeshError::NotFinite`] if a
    /// new point has an infinite or NaN coordinate. [`MeshError::Infeasible`] if the old mesh has inverted or flat
    /// triangles, or quadrilaterals that are not convex, as several elements may then contain a position.
    pub fn new(
        topology: &Topology<'_>,
        old: &[[f64; 2]],
        new: &[[f64; 2]],
    ) -> Result<Interpolation, MeshError> {
        check_feasible(topology, old)?;
        topology.check_count(new)?;
        if let Some(vertex) = new.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
            return Err(MeshError::NotFinite { vertex: vertex as u32 });
        }
        // If stars have been dropped, this line computes them again before several threads need them.
        topology.star(0);
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

    /// Returns the number of moved vertices.
    pub fn moved(&self) -> usize {
        self.moved.len()
    }

    /// Returns the data at the new positions. `values` and the result have `components` numbers per vertex, vertex by
    /// vertex. If a number is infinite or NaN, every value interpolated from it is NaN.
    ///
    /// # Errors
    /// [`MeshError::ValueCount`] if `values` does not have `components` numbers per vertex.
    pub fn apply(&self, values: &[f64], components: usize) -> Result<Vec<f64>, MeshError> {
        let expected = self.vertices.saturating_mul(components);
        if values.len() != expected {
            return Err(MeshError::ValueCount { expected, given: values.len() });
        }
        let mut out = values.to_vec();
        let taken = map_ranges(self.moved.len(), 1 << 12, |range| {
            let taken = self.moved[range].iter().flat_map(|(_, found)| {
                let at = |vertex: u32, component| values[vertex as usize * components + component];
                (0..components).map(move |component| found.value(|vertex| at(vertex, component)))
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

/// Returns [`MeshError::Infeasible`] if triangles are inverted or flat, or if quadrilaterals are not convex.
pub(super) fn check_feasible(
    topology: &Topology<'_>,
    points: &[[f64; 2]],
) -> Result<(), MeshError> {
    let triangles = topology.bad_triangles(points)?;
    let quadrilaterals = topology.bad_quadrilaterals(points)?;
    match triangles.is_empty() && quadrilaterals.is_empty() {
        true => Ok(()),
        false => Err(MeshError::Infeasible { triangles, quadrilaterals }),
    }
}
