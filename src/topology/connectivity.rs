//! The topology of a mesh: consistent windings, free vertices, and the elements and neighbors around each vertex.

use std::sync::OnceLock;

use crate::error::{BadQuadrilateral, BadTriangle, MeshError};
use crate::mesh::{Element, Mesh};
use crate::parallel::counting_sort::Groups;
use crate::parallel::pace::now;
use crate::parallel::{map_parts, map_ranges};
use crate::topology::corners::Corners;
use crate::topology::predicates;
use crate::topology::sides::{BoundaryEdge, boundary_sides};
use crate::topology::stars::{close, doublet, outer_edge, stars as find_stars};
use crate::topology::turns;
use crate::topology::winding::{Majority, NONE, are_positive, neighbors, wind};

/// The elements of a mesh with consistent windings, and its free vertices. Borrows the triangles of a mesh without
/// quadrilaterals if they already are consistent and counter-clockwise.
///
/// The *corners* of a mesh are its triangles, followed by four triangles for each quadrilateral, one for each vertex in the
/// order around it: the vertex, the next vertex and the previous vertex. A quadrilateral is convex and counter-clockwise if
/// its four corners are counter-clockwise.
#[derive(Clone, Debug)]
pub struct Topology<'m> {
    corners: Corners<'m>,
    free: Vec<bool>,
    /// Boundary vertices that [`Mesh::fixed`] lists, ascending.
    fixed_on_boundary: Vec<u32>,
    /// Edges of one element, in the order of the corners.
    pub(super) boundary: Vec<BoundaryEdge>,
    /// The corners at each vertex. Empty after [`Self::forget_stars`], until [`Self::stars`] computes them again.
    stars: OnceLock<Groups>,
}

/// A topology apart from its mesh; see [`Topology::detach`].
#[derive(Clone, Debug)]
pub struct DetachedTopology {
    topology: Topology<'static>,
    /// Whether the mesh has the corners of the topology. A topology of triangles alone borrows the triangles of its mesh.
    lacks_corners: bool,
    elements: usize,
}

impl DetachedTopology {
    /// Joins the topology to its mesh, which must be unchanged but for the positions of vertices. `None` if the mesh has other
    /// numbers of vertices and elements, and so is another mesh.
    pub fn attach(self, mesh: &Mesh) -> Option<Topology<'_>> {
        let Self { topology, lacks_corners, elements } = self;
        let joined = match lacks_corners {
            true => topology.with_corners(Corners::of(mesh)),
            false => topology,
        };
        let of_mesh = mesh.triangles.len() + mesh.quadrilaterals.len();
        (of_mesh == elements && joined.free.len() == mesh.points.len()).then_some(joined)
    }
}

impl<'m> Topology<'m> {
    /// Checks the mesh and finds its windings, boundary and free vertices.
    ///
    /// Windings are made consistent across shared edges, so that most elements of each edge-connected part are
    /// counter-clockwise. If a part has equally many elements of each orientation, the sum of their signed areas
    /// becomes positive. A vertex is free unless it is on the boundary, is listed in [`Mesh::fixed`], is used by no
    /// element, or joins two fans of elements.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::TooLarge`], [`MeshError::NotFinite`], [`MeshError::OutOfRange`],
    /// [`MeshError::IndexOutOfRange`], [`MeshError::RepeatedVertex`], [`MeshError::EdgeOfThree`] or
    /// [`MeshError::Doublet`]. Inverted elements and a lack of free vertices are no errors here:
    /// [`check_smoothable`](Self::check_smoothable) finds both.
    pub fn new(mesh: &'m Mesh) -> Result<Self, MeshError> {
        Self::wound(mesh, Majority::OfElements)
    }

    /// Finds the topology of a mesh that may be tangled. Windings are consistent as in [`new`](Self::new), but the
    /// signed areas of each edge-connected part have a positive sum. This sum is the area that the boundary encloses,
    /// and does not depend on the positions of inner vertices.
    ///
    /// # Errors
    /// [`MeshError::Empty`], [`MeshError::TooLarge`], [`MeshError::NotFinite`], [`MeshError::OutOfRange`],
    /// [`MeshError::IndexOutOfRange`], [`MeshError::RepeatedVertex`], [`MeshError::EdgeOfThree`] or
    /// [`MeshError::Doublet`].
    pub fn by_area(mesh: &'m Mesh) -> Result<Self, MeshError> {
        Self::wound(mesh, Majority::OfArea)
    }

    fn wound(mesh: &'m Mesh, majority: Majority) -> Result<Self, MeshError> {
        let Mesh { points, fixed, .. } = mesh;
        check_indices(mesh)?;
        let mut corners = Corners::of(mesh);
        let mut stars = find_stars(points.len(), &corners);
        check_size(points.len(), |v| if stars.of(v).is_empty() { 0.0 } else { size(points[v]) })?;
        let mut free = vec![false; points.len()];
        // Most meshes are consistent and counter-clockwise already, and the stars alone prove it. The element across
        // each edge is found only for other meshes.
        let is_wound =
            are_positive(points, corners.all()) && close(corners.all(), &mut stars, &mut free);
        if !is_wound {
            corners = wind(points, &corners, &neighbors(&corners, &stars)?, majority);
            if corners.quadrilateral_count() > 0 {
                // A reversed quadrilateral lists its corners in another order.
                stars = find_stars(points.len(), &corners);
            }
            close(corners.all(), &mut stars, &mut free);
        }
        if let Some((vertex, elements)) = doublet(&corners, &stars, &free) {
            return Err(MeshError::Doublet { vertex, elements });
        }
        let boundary = boundary_sides(&corners, &stars, &free);
        let is_on_boundary = |v: &u32| !free[*v as usize];
        let mut fixed_on_boundary: Vec<u32> =
            fixed.iter().copied().filter(is_on_boundary).collect();
        fixed_on_boundary.sort_unstable();
        for &v in fixed {
            free[v as usize] = false;
        }
        Ok(Self { corners, free, fixed_on_boundary, boundary, stars: stars.into() })
    }

    /// Copies the triangles if they are borrowed, so that the topology no longer borrows the mesh.
    pub fn into_owned(self) -> Topology<'static> {
        let (corners, rest) = self.split();
        rest.with_corners(corners.into_owned())
    }

    /// Separates the topology from its mesh, without copying triangles. A program can then store the mesh and its topology in one
    /// struct, and join the two by [`DetachedTopology::attach`].
    pub fn detach(self) -> DetachedTopology {
        let elements = self.element_count();
        let (corners, rest) = self.split();
        let (corners, lacks_corners) = corners.without_borrowed();
        DetachedTopology { topology: rest.with_corners(corners), lacks_corners, elements }
    }

    /// Returns the corners, and a topology without corners.
    fn split(self) -> (Corners<'m>, Topology<'static>) {
        let Self { corners, free, fixed_on_boundary, boundary, stars } = self;
        let none = Corners::of_lists(Vec::new(), &[]);
        (corners, Topology { corners: none, free, fixed_on_boundary, boundary, stars })
    }

    fn with_corners<'n>(self, corners: Corners<'n>) -> Topology<'n> {
        let Self { free, fixed_on_boundary, boundary, stars, .. } = self;
        Topology { corners, free, fixed_on_boundary, boundary, stars }
    }

    /// Checks that the mesh can be smoothed: every triangle is counter-clockwise at `points`, every quadrilateral convex and
    /// counter-clockwise, some vertex is free, and the elements around each free vertex wind around it once.
    ///
    /// Other overlaps pass the check, for example two parts of a mesh over one area.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex, [`MeshError::Infeasible`] if a
    /// corner is inverted or flat at `points`, [`MeshError::NothingFree`] if no vertex is free,
    /// [`MeshError::OverlappingStar`] if elements wind more than once around a free vertex.
    pub fn check_smoothable(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        self.check_count(points)?;
        let is_feasible = turns::is_feasible(points, &self.corners, &self.free);
        if is_feasible && self.free.contains(&true) {
            return Ok(());
        }
        if let Some(error) = now(self.infeasible(points)) {
            return Err(error);
        }
        if !self.free.contains(&true) {
            return Err(MeshError::NothingFree { vertices: points.len() });
        }
        match turns::overlapping_star(points, &self.corners, &self.free) {
            None => Ok(()),
            Some((vertex, turns)) => Err(MeshError::OverlappingStar { vertex, turns }),
        }
    }

    /// Returns the error that lists the corners that are inverted or flat at `points`, by exact predicates. `None` if there is
    /// no such corner. `points` must have one entry per vertex.
    pub(crate) async fn infeasible(&self, points: &[[f64; 2]]) -> Option<MeshError> {
        let bad = predicates::not_positive(points, self.corners()).await;
        (!bad.is_empty()).then(|| {
            let (triangles, quadrilaterals) = self.described(points, &bad);
            MeshError::Infeasible { triangles, quadrilaterals }
        })
    }

    /// Describes corners that are inverted or flat, given in ascending order.
    pub(crate) fn described(
        &self,
        points: &[[f64; 2]],
        bad: &[u32],
    ) -> (Vec<BadTriangle>, Vec<BadQuadrilateral>) {
        let (mut triangles, mut quadrilaterals) = (Vec::new(), Vec::new());
        for &index in bad {
            let vertices = self.corners()[index as usize];
            let flat = predicates::orientation(points, &vertices) == 0.0;
            match self.corners.element(index) {
                Element::Triangle(triangle) => {
                    triangles.push(BadTriangle { triangle, vertices, flat });
                }
                Element::Quadrilateral(quadrilateral) => {
                    let all = self.corners.quadrilateral(quadrilateral);
                    let corner = all.iter().position(|&v| v == vertices[0]).unwrap_or(0);
                    quadrilaterals.push(BadQuadrilateral {
                        quadrilateral,
                        vertices: all,
                        corner,
                        flat,
                    });
                }
            }
        }
        (triangles, quadrilaterals)
    }

    /// Returns the triangles that are inverted or flat with the vertices at `points`, by exact predicates, in ascending
    /// order. Triangles with a coordinate that is not finite count as inverted.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn bad_triangles(&self, points: &[[f64; 2]]) -> Result<Vec<BadTriangle>, MeshError> {
        self.check_count(points)?;
        let bad = now(predicates::not_positive(points, self.triangles()));
        Ok(self.described(points, &bad).0)
    }

    /// Returns the corners of quadrilaterals that are not convex with the vertices at `points`, by exact predicates, in
    /// ascending order. Corners with a coordinate that is not finite count as concave.
    ///
    /// # Errors
    /// [`MeshError::PointCount`] if `points` does not have one entry per vertex.
    pub fn bad_quadrilaterals(
        &self,
        points: &[[f64; 2]],
    ) -> Result<Vec<BadQuadrilateral>, MeshError> {
        self.check_count(points)?;
        let first = self.triangles().len() as u32;
        let mut bad = now(predicates::not_positive(points, self.corners.of_quadrilaterals()));
        bad.iter_mut().for_each(|corner| *corner += first);
        Ok(self.described(points, &bad).1)
    }

    /// Checks new points of the vertices as [`Self::new`] checks those of a mesh. `used` lists the vertices that some element
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

    /// Returns [`MeshError::NotFinite`] for the first vertex of an element with an infinite coordinate or NaN.
    pub(crate) fn check_finite(&self, points: &[[f64; 2]]) -> Result<(), MeshError> {
        let is_finite = |&v: &u32| points[v as usize].iter().all(|x| x.is_finite());
        match self.corners().as_flattened().iter().find(|v| !is_finite(v)) {
            Some(&vertex) => Err(MeshError::NotFinite { vertex }),
            None => Ok(()),
        }
    }

    /// Returns the triangles in the order of the mesh, with consistent windings: counter-clockwise unless inverted.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.corners.triangles()
    }

    /// Returns the vertices of the quadrilaterals in the order of the mesh, with consistent windings: counter-clockwise unless
    /// inverted.
    pub fn quadrilaterals(&self) -> impl ExactSizeIterator<Item = [u32; 4]> + '_ {
        (0..self.corners.quadrilateral_count()).map(|index| self.corners.quadrilateral(index))
    }

    /// Returns the corners of the mesh: its triangles, then four for each quadrilateral, with consistent windings.
    pub fn corners(&self) -> &[[u32; 3]] {
        self.corners.all()
    }

    /// Returns the number of elements: triangles and quadrilaterals.
    pub fn element_count(&self) -> usize {
        self.corners.element_count()
    }

    /// Returns the place of an element among all elements, triangles first, by which [`Measured`](crate::measure::Measured) knows
    /// the element. The place is at least [`element_count`](Self::element_count) if the mesh lacks the quadrilateral.
    pub fn place(&self, element: Element) -> usize {
        match element {
            Element::Triangle(index) => index,
            Element::Quadrilateral(index) => self.triangles().len().saturating_add(index),
        }
    }

    /// Returns the elements of corners that ascend, each element once.
    pub fn elements(&self, corners: &[u32]) -> Vec<Element> {
        let mut elements: Vec<Element> = corners.iter().map(|&c| self.element(c)).collect();
        elements.dedup();
        elements
    }

    /// Returns the element of a corner.
    pub fn element(&self, corner: u32) -> Element {
        self.corners.element(corner)
    }

    /// Returns the corners of the mesh with their elements.
    pub(crate) fn corner_list(&self) -> &Corners<'m> {
        &self.corners
    }

    /// Iterates over the indices of all corners with a vertex: the triangles of its star, and the three corners of each
    /// quadrilateral of its star that have the vertex.
    pub(crate) fn corners_with(&self, vertex: u32) -> impl Iterator<Item = u32> + '_ {
        self.star(vertex).iter().flat_map(|&own| self.corners.beside(own))
    }

    /// Returns for each vertex whether a run may move it.
    pub fn free(&self) -> &[bool] {
        &self.free
    }

    /// Returns whether an element has a free vertex. A run changes no other element. False if the mesh has no such element.
    pub fn can_move(&self, element: Element) -> bool {
        let free = |vertices: &[u32]| vertices.iter().any(|&v| self.free[v as usize]);
        match element {
            Element::Triangle(index) => self.triangles().get(index).is_some_and(|t| free(t)),
            Element::Quadrilateral(index) => {
                let has = index < self.corners.quadrilateral_count();
                has && free(&self.corners.quadrilateral(index))
            }
        }
    }

    /// Returns the number of free vertices.
    pub fn free_count(&self) -> usize {
        self.free.iter().filter(|&&f| f).count()
    }

    /// Returns the indices of the corners at a vertex: a corner for each element with the vertex. A quadrilateral has
    /// the corner whose first vertex is the vertex. Around a free vertex, corners are in counter-clockwise order and start with
    /// the least index; around other vertices, indices ascend. Empty if the mesh has no such vertex.
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

    /// Returns the corners at each vertex, computed if [`Self::forget_stars`] has freed them.
    pub(crate) fn stars(&self) -> &Groups {
        if let Some(known) = self.stars.get() {
            return known;
        }
        // While this thread waits for the loops of `find_stars`, it may run tasks of a loop that asks for the stars too. So no
        // lock is held here: a thread would wait for itself.
        let found = self.find_stars();
        self.stars.get_or_init(|| found)
    }

    /// Frees the memory of the stars. The next access computes them again.
    pub(crate) fn forget_stars(&mut self) {
        self.stars.take();
    }

    #[cold]
    fn find_stars(&self) -> Groups {
        let mut stars = find_stars(self.free.len(), &self.corners);
        close(self.corners(), &mut stars, &mut vec![false; self.free.len()]);
        stars
    }

    /// Returns the one-ring of a free vertex: its neighbors along edges in counter-clockwise order. Neighbor `i` is the next
    /// vertex in corner `i` of [`star`](Self::star); the third vertex is the next neighbor of the ring, cyclically. Empty if the vertex is not free or its index exceeds the mesh.
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
        star.iter().map(move |&t| outer_edge(&self.corners()[t as usize], free_vertex).0)
    }

    /// Iterates over the vertices of the elements around a free vertex, counter-clockwise, from the first neighbor of
    /// [`ring`](Self::ring): neighbors along edges, and the opposite vertex of each quadrilateral, which is marked true.
    pub(crate) fn around(&self, free_vertex: u32) -> impl Iterator<Item = (u32, bool)> + '_ {
        let star = match self.free.get(free_vertex as usize) {
            Some(true) => self.stars().of(free_vertex as usize),
            _ => &[],
        };
        star.iter().flat_map(move |&corner| {
            let (next, _) = outer_edge(&self.corners()[corner as usize], free_vertex);
            let opposite = self.corners.opposite(corner).map(|vertex| (vertex, true));
            [(next, false)].into_iter().chain(opposite)
        })
    }
}

/// Upper limit of the number of vertices. One-rings mark vertices by the highest bit of their numbers.
const MOST_VERTICES: usize = 1 << 31;

/// Checks that the mesh has elements, that indices fit 32 bits and are valid, that coordinates are finite, and that no
/// element repeats a vertex.
fn check_indices(mesh: &Mesh) -> Result<(), MeshError> {
    let Mesh { points, triangles, quadrilaterals, fixed } = mesh;
    if triangles.is_empty() && quadrilaterals.is_empty() {
        return Err(MeshError::Empty);
    }
    let vertices = points.len();
    let corners = triangles.len() + 4 * quadrilaterals.len();
    if vertices >= MOST_VERTICES || corners >= NONE as usize / 3 {
        return Err(MeshError::TooLarge { vertices, triangles: mesh.size().triangles });
    }
    check_finite(points)?;
    check_elements(vertices, triangles, Element::Triangle)?;
    check_elements(vertices, quadrilaterals, Element::Quadrilateral)?;
    match fixed.iter().find(|&&v| v as usize >= vertices) {
        Some(&vertex) => Err(MeshError::IndexOutOfRange { element: None, vertex, vertices }),
        None => Ok(()),
    }
}

/// Checks that the vertices of elements exist, and that no element repeats one.
fn check_elements<const N: usize>(
    vertices: usize,
    elements: &[[u32; N]],
    element: impl Fn(usize) -> Element,
) -> Result<(), MeshError> {
    let count = vertices as u32;
    let is_bad = |corners: &[u32; N]| {
        let mut bad = false;
        for i in 0..N {
            bad |= corners[i] >= count;
            for k in 0..i {
                bad |= corners[i] == corners[k];
            }
        }
        bad
    };
    let Some(index) = first(elements, is_bad) else { return Ok(()) };
    let (corners, element) = (&elements[index], element(index));
    if let Some(&vertex) = corners.iter().find(|&&v| v >= count) {
        return Err(MeshError::IndexOutOfRange { element: Some(element), vertex, vertices });
    }
    let is_repeated = |&i: &usize| corners[i + 1..].contains(&corners[i]);
    match (0..N).find(is_repeated) {
        Some(i) => Err(MeshError::RepeatedVertex { element, vertex: corners[i] }),
        None => Ok(()),
    }
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

/// Checks that the largest coordinate of a vertex that some element uses is from 1e-100 to 1e100 in absolute value.
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
            ..Mesh::default()
        }
    }

    /// A thread that found the stars, and ran a task of the loop that needs them meanwhile, waited for itself.
    #[test]
    fn loops_may_be_the_first_to_need_the_stars() {
        let n = 60;
        let points = (0..n * n).map(|v| [f64::from(v % n), f64::from(v / n)]).collect();
        let cell = |k: u32| {
            let a = k / (n - 1) * n + k % (n - 1);
            [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]
        };
        let triangles = (0..(n - 1) * (n - 1)).flat_map(cell).collect();
        let mesh = Mesh { points, triangles, ..Mesh::default() };
        let mut topology = Topology::new(&mesh).unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(6).build().unwrap();
        for _ in 0..100 {
            topology.forget_stars();
            let of_vertices = pool.install(|| {
                crate::parallel::map_ranges(mesh.points.len(), 64, |range| {
                    range.map(|v| topology.star(v as u32).len()).sum::<usize>()
                })
            });
            assert_eq!(of_vertices.iter().sum::<usize>(), 3 * mesh.triangles.len());
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
    fn a_detached_topology_is_joined_to_its_mesh_again() {
        let mixed = fan();
        let mut wound = fan();
        wound.triangles[2] = [2, 3, 4];
        let squares = Mesh { triangles: vec![], quadrilaterals: vec![[0, 1, 2, 3]], ..fan() };
        for mesh in [mixed, wound, squares] {
            let topology = Topology::new(&mesh).unwrap();
            let joined = topology.clone().detach().attach(&mesh).unwrap();
            assert_eq!(joined.corners(), topology.corners());
            assert_eq!(joined.free(), topology.free());
            assert_eq!(joined.boundary_edges(), topology.boundary_edges());
            assert_eq!(joined.star(0), topology.star(0));
            let mut other = mesh.clone();
            other.points.push([9.0, 9.0]);
            assert!(topology.clone().detach().attach(&other).is_none());
            other = mesh.clone();
            other.triangles.push([0, 1, 2]);
            assert!(topology.detach().attach(&other).is_none());
        }
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
            let quadrilaterals = Vec::new();
            assert_eq!(refusal(&mesh), MeshError::Infeasible { triangles, quadrilaterals });
        }
    }

    #[test]
    fn an_edge_of_three_triangles_is_refused() {
        let mut mesh = fan();
        mesh.triangles.push([0, 4, 2]);
        let error = Topology::new(&mesh).unwrap_err();
        assert!(
            matches!(error, MeshError::EdgeOfThree { ref elements, .. } if elements.len() == 3)
        );
    }

    #[test]
    fn bad_indices_are_refused() {
        let mut mesh = fan();
        mesh.triangles[1][2] = 9;
        let error = Topology::new(&mesh).unwrap_err();
        let expected = MeshError::IndexOutOfRange {
            element: Some(Element::Triangle(1)),
            vertex: 9,
            vertices: 5,
        };
        assert_eq!(error, expected);
        mesh.triangles[1] = [1, 2, 1];
        let error = Topology::new(&mesh).unwrap_err();
        assert_eq!(error, MeshError::RepeatedVertex { element: Element::Triangle(1), vertex: 1 });
        mesh = fan();
        mesh.points[3][1] = 1e200;
        assert_eq!(Topology::new(&mesh).unwrap_err(), MeshError::OutOfRange { size: 1e200 });
        mesh.points[3][1] = f64::NAN;
        assert_eq!(Topology::new(&mesh).unwrap_err(), MeshError::NotFinite { vertex: 3 });
    }
}
