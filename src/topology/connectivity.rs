//! The topology of a mesh: consistent windings, free vertices, and the elements and neighbors around each vertex.

use std::sync::OnceLock;

use crate::error::MeshError;
use crate::mesh::{Element, Mesh};
use crate::parallel::counting_sort::Groups;
use crate::topology::checks::{check_indices, check_size, size};
use crate::topology::corners::Corners;
use crate::topology::sides::{BoundaryEdge, boundary_sides};
use crate::topology::stars::{close, doublet, outer_edge, stars as find_stars};
use crate::topology::winding::{Majority, are_positive, neighbors, wind};

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::BadTriangle;

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
        let search = move || {
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
        };
        // A thread that waits for itself would wait without end.
        let (done, ends) = std::sync::mpsc::channel();
        let searching = std::thread::spawn(move || {
            search();
            done.send(()).unwrap();
        });
        let wait = ends.recv_timeout(std::time::Duration::from_secs(120));
        assert_ne!(wait, Err(std::sync::mpsc::RecvTimeoutError::Timeout), "threads wait");
        searching.join().unwrap();
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
