//! The topology of a mesh: consistent windings, free vertices, and the triangles and neighbors around each vertex.

use std::borrow::Cow;
use std::sync::OnceLock;

use crate::error::{BadTriangle, MeshError};
use crate::mesh::Mesh;
use crate::parallel::counting_sort::Groups;
use crate::parallel::pace::now;
use crate::parallel::{map_parts, map_ranges};
use crate::topology::predicates;
use crate::topology::stars::{close, outer_edge, stars};
use crate::topology::turns;
use crate::topology::winding::{Majority, NONE, are_positive, neighbors, wind};

/// The triangles of a mesh with consistent windings, and its free vertices. Borrows the triangles of the mesh if they
/// already are consistent and counter-clockwise.
#[derive(Clone, Debug)]
pub struct Topology<'m> {
    triangles: Cow<'m, [[u32; 3]]>,
    free: Vec<bool>,
    /// Boundary vertices that [`Mesh::fixed`] lists, ascending.
    fixed_on_boundary: Vec<u32>,
    /// The triangles at each vertex. Empty after [`Self::forget_stars`], until [`Self::stars`] computes them again.
    stars: OnceLock<Groups>,
}

impl<'m> Topology<'m> {
    /// Checks the mesh and finds its windings, boundary and free vertices.
    ///
    /// Windings are made consistent across shared edges, so that most triangles of each edge-connected part are
    /// counter-clockwise. If a part has equally many triangles of each orientation, the sum of their signed areas
    /// becomes positive. A vertex is free unless it is on the boundary, is listed in [`Mesh::fixed`], is used by no
    /// triangle, or joins two fans of triangles.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::TooLarge`], [`MeshError::NotFinite`], [`MeshError::OutOfRange`],
    /// [`MeshError::IndexOutOfRange`], [`MeshError::RepeatedVertex`] or [`MeshError::EdgeOfThree`]. Inverted triangles
    /// and a lack of free vertices are no errors here: [`check_smoothable`](Self::check_smoothable) finds both.
    pub fn new(mesh: &'m Mesh) -> Result<Self, MeshError> {
        Self::wound(mesh, Majority::OfTriangles)
    }

    /// Finds the topology of a mesh that may be tangled. Windings are consistent as in [`new`](Self::new), but the
    /// signed areas of each edge-connected part have a positive sum. This sum is the area that the boundary encloses,
    /// and does not depend on the positions of inner vertices.
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
        check_size(points.len(), |v| if stars.of(v).is_empty() { 0.0 } else { size(points[v]) })?;
        let mut free = vec![false; points.len()];
        // Most meshes are consistent and counter-clockwise already, and the stars alone prove it. The triangle across
        // each edge is found only for other meshes.
        let triangles =
            if are_positive(points, triangles) && close(triangles, &mut stars, &mut free) {
                Cow::Borrowed(triangles.as_slice())
            } else {
                let wound = wind(points, triangles, &neighbors(triangles, &stars)?, majority);
                close(&wound, &mut stars, &mut free);
                Cow::Owned(wound)
            };
        let is_on_boundary = |v: &u32| !free[*v as usize];
        let mut fixed_on_boundary: Vec<u32> =
            fixed.iter().copied().filter(is_on_boundary).collect();
        fixed_on_boundary.sort_unstable();
        for &v in fixed {
            free[v as usize] = false;
        }
        Ok(Self { triangles, free, fixed_on_boundary, stars: stars.into() })
    }

    /// Copies the triangles if they are borrowed, so that the topology no longer borrows the mesh.
    pub fn into_owned(self) -> Topology<'static> {
        let Self { triangles, free, fixed_on_boundary, stars } = self;
        let triangles = Cow::Owned(triangles.into_owned());
        Topology { triangles, free, fixed_on_boundary, stars }
    }

    /// Checks that the mesh can be smoothed: every triangle is counter-clockwise at `points`, some vertex is free, and
    /// the triangles around each free vertex wind around it once.
    ///
    /// Other overlaps pass the check, for example two parts of a mesh over one area.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex, [`MeshError::Infeasible`] if a
    /// triangle is inverted or flat at `points`, [`MeshError::NothingFree`] if no vertex is free,
    /// [`MeshError::OverlappingStar`] if triangles wind more than once around a free vertex.
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
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn bad_triangles(&self, points: &[[f64; 2]]) -> Result<Vec<BadTriangle>, MeshError> {
        self.check_count(points)?;
        Ok(now(predicates::bad_triangles(points, &self.triangles)))
    }

    /// Checks new points of the vertices as [`Self::new`] checks those of a mesh. `used` lists the vertices that some triangle
    /// uses.
    pub(crate) fn check_points(&self, points: &[[f64; 2]], used: &[u32]) -> Result<(), MeshError> {
        self.check_count(points)?;
        check_finite(points)?;
        check_size(used.len(), |i| size(points[used[i] as usize]))
    }

    /// Fails with [`MeshError::PointCount`] unless `points` has one entry per vertex.
    pub(crate) fn check_count(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        let (expected, given) = (self.free.len(), points.len());
        if given == expected { Ok(()) } else { Err(MeshError::PointCount { expected, given }) }
    }

    /// Returns the triangles in the order of the mesh, with consistent windings: counter-clockwise unless inverted.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns for each vertex whether a run may move it.
    pub fn free(&self) -> &[bool] {
        &self.free
    }

    /// Returns whether a triangle has a free vertex. A run changes no other triangle. False if the mesh has no triangle
    /// of this index.
    pub fn can_move(&self, triangle: usize) -> bool {
        self.triangles.get(triangle).is_some_and(|t| t.iter().any(|&v| self.free[v as usize]))
    }

    /// Returns the number of free vertices.
    pub fn free_count(&self) -> usize {
        self.free.iter().filter(|&&f| f).count()
    }

    /// Returns the indices of the triangles at a vertex. Around a free vertex, triangles are in counter-clockwise order
    /// and start with the least index; around other vertices, indices ascend. Empty if the mesh has no such vertex.
    pub fn star(&self, vertex: u32) -> &[u32] {
        match self.free.get(vertex as usize) {
            Some(_) => self.stars().of(vertex as usize),
            None => &[],
        }
    }

    /// Returns the boundary vertices that [`Mesh::fixed`] lists, ascending.
    pub(crate) fn fixed_on_boundary(&self) -> &[u32] {
        &self.fixed_on_boundary
    }

    /// Returns the triangles at each vertex, computed if [`Self::forget_stars`] has freed them.
    pub(crate) fn stars(&self) -> &Groups {
        self.stars.get_or_init(|| self.find_stars())
    }

    /// Frees the memory of the stars. The next access computes them again.
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
    /// after the vertex in triangle `i` of [`star`](Self::star); the third corner is the next neighbor of the ring,
    /// cyclically. Empty if the vertex is not free or its index exceeds the mesh.
    pub fn ring(&self, free_vertex: u32) -> Vec<u32> {
        self.ring_of(free_vertex).collect()
    }

    /// Iterates over the one-ring of a free vertex, in the order of [`ring`](Self::ring).
    #[inline]
    pub(crate) fn ring_of(&self, free_vertex: u32) -> impl Iterator<Item = u32> + '_ {
        let star = match self.free.get(free_vertex as usize) {
            Some(true) => self.stars().of(free_vertex as usize),
            _ => &[],
        };
        star.iter().map(move |&t| outer_edge(&self.triangles[t as usize], free_vertex).0)
    }
}

/// Checks that the mesh has triangles, that indices fit 32 bits and are valid, that coordinates are finite, and that no
/// triangle repeats a vertex.
fn check_indices(mesh: &Mesh) -> Result<(), MeshError> {
    let Mesh { points, triangles, fixed } = mesh;
    if triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    if points.len() >= NONE as usize || triangles.len() >= NONE as usize / 3 {
        return Err(MeshError::TooLarge { vertices: points.len(), triangles: triangles.len() });
    }
    check_finite(points)?;
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

/// Checks that all coordinates are finite.
fn check_finite(points: &[[f64; 2]]) -> Result<(), MeshError> {
    let is_infinite = |p: &[f64; 2]| !(p[0].is_finite() & p[1].is_finite());
    match first(points, is_infinite) {
        None => Ok(()),
        Some(vertex) => Err(MeshError::NotFinite { vertex: vertex as u32 }),
    }
}

/// Returns the index of the first item for which `is_bad` holds.
fn first<T: Sync>(items: &[T], is_bad: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    const CHUNK: usize = 1 << 14;
    // Every item of a chunk is tested, as a loop without branches is faster than a loop that may end early.
    let any = |_, chunk: &[T]| chunk.iter().fold(false, |any, item| any | is_bad(item));
    let chunk = map_parts(items.chunks(CHUNK), any).into_iter().position(|any| any)?;
    items.iter().skip(chunk * CHUNK).position(is_bad).map(|i| chunk * CHUNK + i)
}

/// Returns the larger coordinate of a point, in absolute value.
fn size(point: [f64; 2]) -> f64 {
    point[0].abs().max(point[1].abs())
}

/// Checks that the largest coordinate of a vertex that some triangle uses is from 1e-100 to 1e100 in absolute value.
/// Unused vertices may be anywhere. `size` returns the larger coordinate of each of `count` vertices, 0 for an unused
/// vertex.
fn check_size(count: usize, size: impl Fn(usize) -> f64 + Sync) -> Result<(), MeshError> {
    let sizes = map_ranges(count, 1 << 14, |range| range.map(&size).fold(0.0, f64::max));
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
