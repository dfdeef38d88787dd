//! The corners of a mesh: its triangles, and four triangles for each quadrilateral.

use std::borrow::Cow;

use crate::mesh::{Element, Mesh};

/// The corners of a mesh: its triangles, followed by four for each quadrilateral, one for each vertex in the order around it.
/// The corner of a quadrilateral has its own vertex first, then the next and the previous vertex of the quadrilateral.
#[derive(Clone, Debug)]
pub(crate) struct Corners<'m> {
    all: Cow<'m, [[u32; 3]]>,
    /// Number of triangles.
    triangles: usize,
}

impl<'m> Corners<'m> {
    /// Returns the corners of a mesh. Borrows the triangles of a mesh without quadrilaterals.
    pub(crate) fn of(mesh: &'m Mesh) -> Self {
        let Mesh { triangles, quadrilaterals, .. } = mesh;
        match quadrilaterals.is_empty() {
            true => Self { all: Cow::Borrowed(triangles), triangles: triangles.len() },
            false => Self::of_lists(triangles.clone(), quadrilaterals),
        }
    }

    /// Returns the corners of lists of elements.
    pub(crate) fn of_lists(
        triangles: Vec<[u32; 3]>,
        quadrilaterals: &[[u32; 4]],
    ) -> Corners<'static> {
        let count = triangles.len();
        let mut all = triangles;
        all.extend(quadrilaterals.iter().flat_map(of_quadrilateral));
        Corners { all: Cow::Owned(all), triangles: count }
    }

    /// Returns owned corners as they are, and an empty list for borrowed corners. The second value is true for borrowed corners.
    pub(crate) fn without_borrowed(self) -> (Corners<'static>, bool) {
        match self.all {
            Cow::Owned(all) => (Corners { all: Cow::Owned(all), triangles: self.triangles }, false),
            Cow::Borrowed(_) => (Corners { all: Cow::Owned(Vec::new()), triangles: 0 }, true),
        }
    }

    pub(crate) fn into_owned(self) -> Corners<'static> {
        Corners { all: Cow::Owned(self.all.into_owned()), triangles: self.triangles }
    }

    /// Returns all corners, the triangles first.
    #[inline(always)]
    pub(crate) fn all(&self) -> &[[u32; 3]] {
        &self.all
    }

    /// Returns the triangles.
    #[inline(always)]
    pub(crate) fn triangles(&self) -> &[[u32; 3]] {
        &self.all[..self.triangles]
    }

    /// Returns the corners of the quadrilaterals, four for each.
    #[inline(always)]
    pub(crate) fn of_quadrilaterals(&self) -> &[[u32; 3]] {
        &self.all[self.triangles..]
    }

    /// Returns the number of quadrilaterals.
    pub(crate) fn quadrilateral_count(&self) -> usize {
        self.of_quadrilaterals().len() / 4
    }

    /// Returns the number of triangles, and the number of equilateral triangles whose area is that of as many squares as there
    /// are quadrilaterals, with sides of equal length.
    pub(crate) fn equivalent_triangles(&self) -> f64 {
        const PER_SQUARE: f64 = 4.0 / 1.732_050_807_568_877_2;
        self.triangles as f64 + self.quadrilateral_count() as f64 * PER_SQUARE
    }

    /// Returns the number of elements.
    pub(crate) fn element_count(&self) -> usize {
        self.triangles + self.quadrilateral_count()
    }

    /// Returns the vertices of a quadrilateral, in order around it.
    pub(crate) fn quadrilateral(&self, index: usize) -> [u32; 4] {
        let first = self.triangles + 4 * index;
        std::array::from_fn(|k| self.all[first + k][0])
    }

    /// Returns the element of a corner.
    pub(crate) fn element(&self, corner: u32) -> Element {
        match (corner as usize).checked_sub(self.triangles) {
            None => Element::Triangle(corner as usize),
            Some(of_quadrilaterals) => Element::Quadrilateral(of_quadrilaterals / 4),
        }
    }

    /// Returns the number of the element of a corner: triangles are numbered first.
    #[inline]
    pub(crate) fn number(&self, corner: u32) -> usize {
        match (corner as usize).checked_sub(self.triangles) {
            None => corner as usize,
            Some(of_quadrilaterals) => self.triangles + of_quadrilaterals / 4,
        }
    }

    /// Returns the first corner of the element of a corner: equal for all corners of an element, and ascending in the order of
    /// elements.
    pub(crate) fn first(&self, corner: u32) -> u32 {
        match (corner as usize).checked_sub(self.triangles) {
            None => corner,
            Some(of_quadrilaterals) => corner - (of_quadrilaterals % 4) as u32,
        }
    }

    /// Returns the first corner of each element, the triangles first.
    pub(crate) fn firsts(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.triangles).chain((self.triangles..self.all.len()).step_by(4)).map(|c| c as u32)
    }

    /// Returns the corners of an element that have the first vertex of its corner `own`: a triangle itself, or the corner
    /// `own` of a quadrilateral with the corners before and after.
    pub(crate) fn beside(&self, own: u32) -> impl Iterator<Item = u32> + use<> {
        let first = self.first(own);
        let turn = own - first;
        let is_triangle = self.is_triangle(own);
        let count = if is_triangle { 1 } else { 3 };
        [turn, (turn + 1) % 4, (turn + 3) % 4].into_iter().take(count).map(move |k| first + k)
    }

    /// Returns the vertex of a quadrilateral opposite to the first vertex of a corner. `None` for a triangle.
    #[inline(always)]
    pub(crate) fn opposite(&self, corner: u32) -> Option<u32> {
        let of_quadrilaterals = (corner as usize).checked_sub(self.triangles)?;
        let turn = of_quadrilaterals % 4;
        Some(self.all[corner as usize - turn + (turn + 2) % 4][0])
    }

    /// Returns the corner of the element of `corner` at a vertex, and the place of the vertex in this corner. `None` if the
    /// element lacks the vertex.
    pub(crate) fn at(&self, corner: u32, vertex: u32) -> Option<(u32, usize)> {
        if self.is_triangle(corner) {
            let place = self.all[corner as usize].iter().position(|&v| v == vertex)?;
            return Some((corner, place));
        }
        let first = self.first(corner);
        let own = (first..first + 4).find(|&own| self.all[own as usize][0] == vertex)?;
        Some((own, 0))
    }

    /// Returns whether a corner is a triangle of the mesh.
    pub(crate) fn is_triangle(&self, corner: u32) -> bool {
        (corner as usize) < self.triangles
    }

    /// Returns the sides of an element that belong to a corner, each with the first corner of the element: all three sides of a
    /// triangle, and the side of a quadrilateral from the first vertex of the corner to the next. The sides of all corners, in
    /// order, are the sides of all elements.
    pub(crate) fn sides(&self, corner: usize) -> impl Iterator<Item = (u32, [u32; 2])> + use<> {
        let [a, b, c] = self.all[corner];
        let first = self.first(corner as u32);
        let count = if self.is_triangle(corner as u32) { 3 } else { 1 };
        [[a, b], [b, c], [c, a]].into_iter().take(count).map(move |ends| (first, ends))
    }

    /// Returns the place of the first side of a corner in the list of all sides.
    pub(crate) fn first_side(&self, corner: u32) -> usize {
        corner as usize + 2 * self.triangles.min(corner as usize)
    }

    /// Returns the vertex that follows a vertex around an element, given a corner of the element. `None` if the element lacks
    /// the vertex.
    pub(crate) fn next(&self, corner: u32, vertex: u32) -> Option<u32> {
        let (own, place) = self.at(corner, vertex)?;
        Some(self.all[own as usize][(place + 1) % 3])
    }

    /// Reverses the winding of an element, given its first corner.
    pub(crate) fn reverse(&mut self, first: u32) {
        let is_triangle = self.is_triangle(first);
        let first = first as usize;
        let all = self.all.to_mut();
        if is_triangle {
            all[first].swap(1, 2);
        } else {
            let [p, q, r, s] = std::array::from_fn(|k| all[first + k][0]);
            all[first..first + 4].copy_from_slice(&of_quadrilateral(&[p, s, r, q]));
        }
    }
}

/// Returns the four corners of a quadrilateral.
fn of_quadrilateral(&[p, q, r, s]: &[u32; 4]) -> [[u32; 3]; 4] {
    [[p, q, s], [q, r, p], [r, s, q], [s, p, r]]
}
