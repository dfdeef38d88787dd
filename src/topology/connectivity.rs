//! The topology of a mesh: consistent windings, free vertices, and the triangles and neighbors around each vertex.

use std::borrow::Cow;
use std::sync::OnceLock;

use crate::error::{BadTriangle, MeshError};
use crate::mesh::Mesh;
use crate::parallel::counting_sort::Groups;
use crate::parallel::{map_parts, map_ranges};
use crate::topology::predicates;
use crate::topology::stars::{close, outer_edge, stars};
use crate::topology::turns;
use crate::topology::winding::{Majority, NONE, are_positive, neighbors, wind};

/// The triangles of a mesh with consistent windings, and its free vertices. Borrows the mesh's triangles if they
/// already are consistent and counter-clockwise.
#[derive(Clone, Debug)]
pub struct Topology<'m> {
    triangles: Cow<'m, [[u32; 3]]>,
    free: Vec<bool>,
    /// The triangles at each vertex. Empty after [`Self::forget_stars`], until they are needed again.
    stars: OnceLock<Groups>,
}

impl<'m> Topology<'m> {
    /// Checks the mesh and finds its windings, boundary and free vertices.
    ///
    /// Windings are made consistent across shared edges, so that most triangles of each edge-connected part are
    /// counter-clockwise. If equally many are clockwise, the sum of their areas decides. A vertex is free unless it is
    /// on the boundary, is listed in [`Mesh::fixed`], is used by no triangle, or joins two fans of triangles.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::TooLarge`], [`MeshError::NotFinite`], [`MeshError::OutOfRange`],
    /// [`MeshError::IndexOutOfRange`], [`MeshError::RepeatedVertex`] or [`MeshError::EdgeOfThree`].
    /// [`check_smoothable`](Self::check_smoothable) checks whether the mesh is feasible and has a free vertex.
    pub fn new(mesh: &'m Mesh) -> Result<Self, MeshError> {
        Self::wound(mesh, Majority::OfTriangles)
    }

    /// Finds the topology of a mesh that may be tangled. Windings are made consistent as in [`new`](Self::new), but so
    /// that the signed areas of each part have a positive sum. That sum is the area which the boundary encloses, and
    /// does not depend on the vertices inside.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::TooLarge`], [`MeshError::NotFinite`], [`MeshError::OutOfRange`],
    /// [`MeshError::IndexOutOfRange`], [`MeshError::RepeatedVertex`] or [`MeshError::EdgeOfThree`].
    pub fn by_area(mesh: &'m Mesh) -> Result<Self, MeshError> {
        Self::wound(mesh, Majority::OfArea)
    }

    fn wound(mesh: &'m Mesh, majority: Majority) -> Result<Self, MeshError> {
        let Mesh { points, triangles, fixed } = mesh;
        check_indices(mesh)?;
        let mut stars = stars(points.len(), triangles);
        check_size(points, &stars)?;
        let mut free = vec![false; points.len()];
        // Most meshes are consistent and counter-clockwise already. The stars are enough to see that.
        let triangles =
            if are_positive(points, triangles) && close(triangles, &mut stars, &mut free) {
                Cow::Borrowed(triangles.as_slice())
            } else {
                let wound = wind(points, triangles, &neighbors(triangles, &stars)?, majority);
                close(&wound, &mut stars, &mut free);
                Cow::Owned(wound)
            };
        for &v in fixed {
            free[v as usize] = false;
        }
        Ok(Self { triangles, free, stars: stars.into() })
    }

    /// Copies the triangles if they are borrowed, so that the topology no longer borrows the mesh.
    pub fn into_owned(self) -> Topology<'static> {
        let Self { triangles, free, stars } = self;
        Topology { triangles: Cow::Owned(triangles.into_owned()), free, stars }
    }

    /// Checks that the mesh can be smoothed: every triangle is counter-clockwise at `points`, some vertex is free, and
    /// the triangles around each free vertex wind around it once.
    ///
    /// Other overlaps of parts of a mesh are not found.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex, [`MeshError::Infeasible`] if a triangle is
    /// inverted or flat at `points`, [`MeshError::NothingFree`] if no vertex is free, [`MeshError::OverlappingStar`] if
    /// triangles wind more than once around a free vertex.
    pub fn check_smoothable(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        self.check_count(points)?;
        let is_feasible = turns::is_feasible(points, &self.triangles, &self.free);
        if is_feasible && self.free.contains(&true) {
            return Ok(());
        }
        let triangles = self.bad_triangles(points)?;
        if !triangles.is_empty() {
            return Err(MeshError::Infeasible { triangles });
        }
        if !self.free.contains(&true) {
            return Err(MeshError::NothingFree { vertices: points.len() });
        }
        match turns::overlapping_star(points, &self.triangles, &self.free) {
            None => Ok(()),
            Some((vertex, turns)) => Err(MeshError::OverlappingStar { vertex, turns }),
        }
    }

    /// Returns the triangles that are inverted or flat with the vertices at `points`, by exact predicates, in ascending
    /// order. Triangles with a coordinate that is not finite count as inverted.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if there is not one point for each vertex.
    pub fn bad_triangles(&self, points: &[[f64; 2]]) -> Result<Vec<BadTriangle>, MeshError> {
        self.check_count(points)?;
        Ok(predicates::bad_triangles(points, &self.triangles))
    }

    /// Fails unless there is one point for each vertex.
    pub(crate) fn check_count(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        let (expected, given) = (self.free.len(), points.len());
        if given == expected { Ok(()) } else { Err(MeshError::PointCount { expected, given }) }
    }

    /// Returns the triangles in the mesh's order, with consistent windings: counter-clockwise unless inverted.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns for each vertex of the mesh whether it is free to move.
    pub fn free(&self) -> &[bool] {
        &self.free
    }

    /// Whether a triangle has a free vertex. Other triangles stay as they are in a run. False for a triangle that the mesh
    /// does not have.
    pub fn can_move(&self, triangle: usize) -> bool {
        self.triangles.get(triangle).is_some_and(|t| t.iter().any(|&v| self.free[v as usize]))
    }

    /// Returns the number of free vertices.
    pub fn free_count(&self) -> usize {
        self.free.iter().filter(|&&f| f).count()
    }

    /// Returns the indices of the triangles at a vertex. Around a free vertex they are in counter-clockwise order,
    /// starting with the least. Empty for a vertex that the mesh does not have.
    pub fn star(&self, vertex: u32) -> &[u32] {
        match self.free.get(vertex as usize) {
            Some(_) => self.stars().of(vertex as usize),
            None => &[],
        }
    }

    /// Returns the triangles at each vertex.
    pub(crate) fn stars(&self) -> &Groups {
        self.stars.get_or_init(|| self.find_stars())
    }

    /// Frees the memory of the stars. They are found again when one is needed.
    pub(crate) fn forget_stars(&mut self) {
        self.stars.take();
    }

    #[cold]
    fn find_stars(&self) -> Groups {
        let mut stars = stars(self.free.len(), &self.triangles);
        close(&self.triangles, &mut stars, &mut vec![false; self.free.len()]);
        stars
    }

    /// Returns the one-ring of a free vertex: its neighbors in counter-clockwise order. Neighbor `i` is the next corner
    /// after the vertex in triangle `i` of [`star`](Self::star); the third corner is the neighbor after it, cyclically.
    /// Empty for a vertex that is not free, or that the mesh does not have.
    pub fn ring(&self, free_vertex: u32) -> Vec<u32> {
        self.ring_of(free_vertex).collect()
    }

    /// Iterates over the one-ring of a free vertex; see [`ring`](Self::ring).
    #[inline]
    pub(crate) fn ring_of(&self, free_vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let star = match self.free.get(free_vertex as usize) {
            Some(true) => self.stars().of(free_vertex as usize),
            _ => &[],
        };
        star.iter().map(move |&t| outer_edge(&self.triangles[t as usize], free_vertex).0)
    }
}

/// Checks the lengths of lists, that coordinates are finite, and that indices are valid.
fn check_indices(mesh: &Mesh) -> Result<(), MeshError> {
    let Mesh { points, triangles, fixed } = mesh;
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    if points.len() >= NONE as usize || triangles.len() >= NONE as usize / 3 {
        return Err(MeshError::TooLarge { vertices: points.len(), triangles: triangles.len() });
    }
    let is_infinite = |p: &[f64; 2]| !(p[0].is_finite() & p[1].is_finite());
    if let Some(vertex) = first(points, is_infinite) {
        return Err(MeshError::NotFinite { vertex: vertex as u32 });
    }
    let count = points.len() as u32;
    let is_bad = |t: &[u32; 3]| {
        let outside = (t[0] >= count) | (t[1] >= count) | (t[2] >= count);
        outside | (t[0] == t[1]) | (t[1] == t[2]) | (t[2] == t[0])
    };
    if let Some(t) = first(triangles, is_bad) {
        let corners = &triangles[t];
        for (i, &vertex) in corners.iter().enumerate() {
            if vertex as usize >= points.len() {
                let vertices = points.len();
                return Err(MeshError::IndexOutOfRange { triangle: Some(t), vertex, vertices });
            }
            if vertex == corners[(i + 1) % 3] {
                return Err(MeshError::RepeatedVertex { triangle: t, vertex });
            }
        }
    }
    if let Some(&vertex) = fixed.iter().find(|&&v| v as usize >= points.len()) {
        let vertices = points.len();
        return Err(MeshError::IndexOutOfRange { triangle: None, vertex, vertices });
    }
    Ok(())
}

/// Returns the index of the first bad item.
fn first<T: Sync>(items: &[T], is_bad: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    const CHUNK: usize = 1 << 14;
    // All items of a chunk are checked, as this takes no branches.
    let any = |_, chunk: &[T]| chunk.iter().fold(false, |any, item| any | is_bad(item));
    let chunk = map_parts(items.chunks(CHUNK), any).into_iter().position(|any| any)?;
    items.iter().skip(chunk * CHUNK).position(is_bad).map(|i| chunk * CHUNK + i)
}

/// Checks that coordinates are neither too large nor all too small to compute with. Vertices that no triangle uses may
/// be anywhere.
fn check_size(points: &[[f64; 2]], stars: &Groups) -> Result<(), MeshError> {
    let size = |v: usize| match stars.of(v) {
        [] => 0.0,
        _ => points[v][0].abs().max(points[v][1].abs()),
    };
    let sizes = map_ranges(points.len(), 1 << 14, |range| range.map(size).fold(0.0, f64::max));
    let size = sizes.into_iter().fold(0.0, f64::max);
    match size {
        1e-100..=1e100 => Ok(()),
        _ => Err(MeshError::OutOfRange { size }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square with its center. All triangles are counter-clockwise except the third.
    fn fan() -> Mesh {
        Mesh {
            points: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0], [1.0, 0.9]],
            triangles: vec![[0, 1, 4], [1, 2, 4], [2, 4, 3], [3, 0, 4]],
            fixed: vec![],
        }
    }

    #[test]
    fn mixed_windings_are_normalized() {
        let mut mesh = fan();
        let topology = Topology::new(&mesh).unwrap();
        assert_eq!(topology.triangles()[2], [2, 3, 4]);
        assert_eq!(topology.free(), [false, false, false, false, true]);
        assert_eq!(topology.ring(4), [0, 1, 2, 3]);
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        let clockwise = Topology::new(&mesh).unwrap();
        assert_eq!(clockwise.bad_triangles(&mesh.points), Ok(vec![]));
    }

    #[test]
    fn constraint_vertices_are_not_free() {
        let mesh = Mesh { fixed: vec![4], ..fan() };
        let topology = Topology::new(&mesh).unwrap();
        let error = topology.check_smoothable(&mesh.points).unwrap_err();
        assert_eq!(error, MeshError::NothingFree { vertices: 5 });
    }

    #[test]
    fn folds_and_flat_triangles_are_refused() {
        let mut mesh = fan();
        let refusal =
            |mesh: &Mesh| Topology::new(mesh).unwrap().check_smoothable(&mesh.points).unwrap_err();
        for (place, flat) in [([1.0, -0.5], false), ([1.0, 0.0], true)] {
            mesh.points[4] = place;
            let triangles = vec![BadTriangle { triangle: 0, vertices: [0, 1, 4], flat }];
            assert_eq!(refusal(&mesh), MeshError::Infeasible { triangles });
        }
    }

    #[test]
    fn an_edge_of_three_triangles_is_refused() {
        let mut mesh = fan();
        mesh.triangles.push([0, 4, 2]);
        let error = Topology::new(&mesh).unwrap_err();
        assert!(
            matches!(error, MeshError::EdgeOfThree { ref triangles, .. } if triangles.len() == 3)
        );
    }

    #[test]
    fn bad_indices_are_refused() {
        let mut mesh = fan();
        mesh.triangles[1][2] = 9;
        let error = Topology::new(&mesh).unwrap_err();
        let expected = MeshError::IndexOutOfRange { triangle: Some(1), vertex: 9, vertices: 5 };
        assert_eq!(error, expected);
        mesh.triangles[1] = [1, 2, 1];
        let error = Topology::new(&mesh).unwrap_err();
        assert_eq!(error, MeshError::RepeatedVertex { triangle: 1, vertex: 1 });
        mesh = fan();
        mesh.points[3][1] = 1e200;
        assert_eq!(Topology::new(&mesh).unwrap_err(), MeshError::OutOfRange { size: 1e200 });
        mesh.points[3][1] = f64::NAN;
        assert_eq!(Topology::new(&mesh).unwrap_err(), MeshError::NotFinite { vertex: 3 });
    }
}
