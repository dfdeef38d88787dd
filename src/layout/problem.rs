//! The input of the engines: normalized positions and one-rings, numbered color by color.

use std::collections::HashSet;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;

use glam::DVec2;

use crate::layout::Coloring;
use crate::layout::bounds::Bounds;
use crate::layout::curve::along_curve;
use crate::layout::mercator::Mercator;
use crate::layout::numbering::{OPPOSITE, elements, order, rings};
use crate::layout::placement::{Placement, mean_area};
use crate::mesh::Mesh;
use crate::metric::{Corner, Ideal, TargetMap};
use crate::parallel::counting_sort::{atomics, plain};
use crate::parallel::{collect, for_each_part, paced};
use crate::targets::Targets;
use crate::topology::{Corners, Topology};

/// Number of vertices or triangles that one task handles.
const CHUNK: usize = 1 << 12;

/// A mesh laid out for sweeping. Vertices are renumbered: first the free vertices, color by color, then the fixed
/// vertices that some element uses. The vertices of a color are in blocks along a space-filling curve, and within a
/// block they are ordered by the number of their neighbors and by their elements.
///
/// Positions are scaled by a power of two so that the mean area of triangles is in [0.5, 2], and the center of a
/// mesh far from the origin is subtracted. Neither operation rounds, so even the smallest elements keep all digits of
/// their coordinates. Single precision then suffices for meshes of any size and position, and areas far below or above
/// the mean neither underflow nor overflow.
///
/// Maps are in single precision, so that both engines use equal values. A clone shares the layout and the maps.
#[derive(Clone, Debug)]
pub struct Problem {
    pub(super) layout: Arc<Layout>,
    pub(super) placement: Arc<Placement>,
    /// Projection from the coordinates of the mesh to the plane in which sweeps move vertices. `None` if sweeps move
    /// vertices in the coordinates of the mesh.
    pub(super) projection: Option<Mercator>,
    /// Target map of each vertex. `None` without targets.
    targets: Option<Arc<[[f32; 3]]>>,
    /// Local map of each vertex. `None` unless the mesh is strongly stretched.
    local_maps: Option<Arc<[[f32; 3]]>>,
    /// Whether some target map is anisotropic.
    has_stretched_targets: bool,
    /// Whether coarse levels work in the coordinates of the plane even if a map is anisotropic.
    levels_in_plane: bool,
    ideal: Ideal,
    /// Elements over whose squared qualities the objective is the mean: all elements, or those that can move.
    judged: Judged,
    /// Bounds on the free vertices. `None` without bounds.
    pub(super) bounds: Option<Arc<Bounds>>,
}

/// The elements over which the objective is the mean: of each kind, the first `count` corners of a list.
#[derive(Clone, Debug)]
struct Judged {
    /// All triangles, with the judged triangles first. `None` if the list of the layout begins with them.
    reordered: Option<Arc<[[u32; 3]]>>,
    count: usize,
    /// All corners of quadrilaterals, with those of judged quadrilaterals first. `None` if the list of the layout begins with
    /// them.
    reordered_corners: Option<Arc<[[u32; 3]]>>,
    corner_count: usize,
}

/// Corners of one kind of element: triangles, or four corners of each quadrilateral.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CornerPart<'p> {
    pub(crate) corners: &'p [[u32; 3]],
    /// Whether the corners are of quadrilaterals, whose ideal has a right angle.
    pub(crate) is_right: bool,
}

impl<'p> CornerPart<'p> {
    /// Returns the weight of a corner in the objective: 1 for a triangle, 1/4 for a corner of a quadrilateral.
    pub(crate) fn weight(self) -> f64 {
        if self.is_right { 0.25 } else { 1.0 }
    }

    /// Splits the corners into parts of at most `size` corners.
    pub(crate) fn chunks(self, size: usize) -> impl Iterator<Item = CornerPart<'p>> {
        self.corners.chunks(size).map(move |corners| CornerPart { corners, ..self })
    }
}

/// The linear maps that a device stores at the vertices of a problem. A problem with targets and local maps is for the
/// CPU alone.
#[cfg(feature = "gpu")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum MapKind {
    /// No maps.
    None,
    /// Target maps: metrics measure triangles transformed by the maps at their corners. Newton directions and coarser
    /// levels use the coordinates of the maps.
    Targets,
    /// Local maps: Newton directions and coarser levels use the coordinates of the maps. Metrics measure triangles of
    /// the plane.
    Local,
}

#[cfg(all(feature = "gpu", test))]
impl MapKind {
    pub(crate) const ALL: [Self; 3] = [MapKind::None, MapKind::Targets, MapKind::Local];
}

/// Layout of a [`Problem`]: order and connectivity, independent of positions and targets.
#[derive(Debug)]
pub(super) struct Layout {
    colors: Vec<Range<u32>>,
    ring_start: Vec<u32>,
    ring: Vec<u32>,
    corners: Corners<'static>,
    pub(super) vertices: Vec<u32>,
}

impl Problem {
    /// Lays out a mesh with its topology and coloring.
    pub fn new(mesh: &Mesh, topology: &Topology<'_>, coloring: &Coloring) -> Self {
        Self::along(mesh, topology, coloring, &along_curve(mesh, topology))
    }

    /// Lays out a mesh as [`Self::new`] does. `curve` lists the vertices that some element uses, in the order of a
    /// curve.
    pub(crate) fn along(
        mesh: &Mesh,
        topology: &Topology<'_>,
        coloring: &Coloring,
        curve: &[u32],
    ) -> Self {
        let (vertices, colors) = order(topology, coloring, curve);
        let number = atomics(mesh.points.len(), u32::MAX);
        for_each_part(vertices.chunks(CHUNK), |chunk, vertices| {
            for (&v, new) in vertices.iter().zip(chunk * CHUNK..) {
                number[v as usize].store(new as u32, Relaxed);
            }
        });
        let number = plain(number);

        let free = colors.last().map_or(0, |range| range.end) as usize;
        let (ring_start, ring) = rings(topology, &vertices[..free], curve, &number);
        let corners = elements(topology, vertices.len(), &number);
        drop(number);
        let layout = Layout { colors, ring_start, ring, corners, vertices };
        Self::placed(Arc::new(layout), mesh, topology)
    }

    /// Returns the problem of a mesh with other points. Colors, one-rings, elements and the order of vertices are shared with
    /// this problem. The returned problem has neither projection nor maps nor bounds, and is judged by all elements.
    pub(crate) fn at_points(&self, mesh: &Mesh, topology: &Topology<'_>) -> Self {
        Self::placed(Arc::clone(&self.layout), mesh, topology)
    }

    fn placed(layout: Arc<Layout>, mesh: &Mesh, topology: &Topology<'_>) -> Self {
        let (placement, mean_area) =
            Placement::of(mesh, topology, &layout.vertices, &layout.corners);
        let judged = Judged {
            reordered: None,
            count: layout.corners.triangles().len(),
            reordered_corners: None,
            corner_count: layout.corners.of_quadrilaterals().len(),
        };
        Self {
            layout,
            placement: Arc::new(placement),
            projection: None,
            targets: None,
            local_maps: None,
            has_stretched_targets: false,
            levels_in_plane: false,
            ideal: Ideal::of_area(mean_area),
            judged,
            bounds: None,
        }
    }

    /// Returns the problem of a projected mesh as the problem of the mesh before the projection.
    pub(crate) fn with_projection(self, projection: Mercator) -> Self {
        Self { projection: Some(projection), ..self }
    }

    /// Sets the target maps of all vertices of the mesh, in any unit, and the weight of sizes. A common factor scales the
    /// maps so that the mean area of triangles, after their maps are applied, is 1.
    pub(crate) fn set_targets(&mut self, targets: &Targets) {
        let placement = Arc::clone(&self.placement);
        self.set_targets_at(targets, &placement.positions);
    }

    /// Sets targets as [`set_targets`](Self::set_targets) does, but scales maps for vertices at the given
    /// normalized positions. Local maps do not change.
    pub(crate) fn set_targets_at(&mut self, targets: &Targets, positions: &[DVec2]) {
        let map = |v: u32| targets.maps()[v as usize].0;
        let area = |t: &[u32; 3]| {
            let [p, q, r] = t.map(|v| positions[v as usize]);
            let map = TargetMap::mean(t.map(|v| map(self.layout.vertices[v as usize])));
            let [a, b] = [q - p, r - p].map(|edge| map.apply(edge.to_array()));
            0.5 * (a[0] * b[1] - a[1] * b[0])
        };
        let scale = mean_area(&self.layout.corners, area).sqrt().recip();
        let scaled = |v: u32| map(v).map(|x| (x * scale) as f32);
        let maps = collect(self.layout.vertices.len(), |i| scaled(self.layout.vertices[i]));
        let is_longer = |&[xx, xy, yy]: &[f32; 3]| xx != yy || xy != 0.0;
        self.has_stretched_targets = maps.iter().any(is_longer);
        self.targets = Some(maps.into());
        let transformed_area =
            |t: &[u32; 3]| 0.5 * self.corner(t, |v| positions[v as usize]).doubled_area();
        self.ideal = Ideal {
            area: mean_area(&self.layout.corners, transformed_area),
            size_weight: targets.size_weight(),
            is_right: false,
        };
    }

    /// Sets the local maps, one for each vertex in the order of the positions. Newton directions and coarser levels then
    /// use the coordinates of the local maps, and metrics still measure triangles transformed by the target maps, if the
    /// mesh has targets.
    pub(crate) fn set_local_maps(&mut self, maps: Vec<[f32; 3]>) {
        self.local_maps = Some(maps.into());
    }

    /// Copies the local maps of another problem of equal layout, and the coordinates in which its coarser levels work. Removes
    /// the local maps if the other problem has none.
    pub(crate) fn share_maps_of_levels(&mut self, other: &Self) {
        self.local_maps.clone_from(&other.local_maps);
        self.levels_in_plane = other.levels_in_plane;
    }

    /// Copies the targets of another problem of the same mesh. `number` has the index in `other` of each vertex of the
    /// mesh.
    #[cfg(feature = "gpu")]
    pub(crate) fn take_targets(&mut self, other: &Self, number: &[u32]) {
        if let Some(maps) = other.targets() {
            let of = |&v: &u32| maps[number[v as usize] as usize];
            self.targets = Some(self.layout.vertices.iter().map(of).collect());
        }
        self.has_stretched_targets = other.has_stretched_targets;
        self.ideal = other.ideal;
    }

    /// Returns the normalized position of each vertex.
    pub fn positions(&self) -> &[DVec2] {
        &self.placement.positions
    }

    /// Returns the range of free vertices of each color.
    pub fn colors(&self) -> &[Range<u32>] {
        &self.layout.colors
    }

    /// Returns the number of free vertices. Free vertices have the indices from 0 to this number, exclusive.
    pub fn free_count(&self) -> usize {
        self.layout.ring_start.len() - 1
    }

    /// Returns whether a triangle has a free vertex, given the three vertices of the triangle.
    pub(crate) fn can_move(&self, triangle: &[u32; 3]) -> bool {
        triangle.iter().any(|&v| (v as usize) < self.free_count())
    }

    /// Returns the index in [`Self::ring`] of the first neighbor of each free vertex, and at the end the length of the
    /// ring.
    pub fn ring_start(&self) -> &[u32] {
        &self.layout.ring_start
    }

    /// Returns the vertices of the elements around all free vertices, vertex by vertex, counter-clockwise around each vertex.
    /// The list of a vertex starts with a neighbor along an edge. Between two neighbors in a quadrilateral stands the
    /// opposite vertex, with `OPPOSITE` added to its number.
    pub fn ring(&self) -> &[u32] {
        &self.layout.ring
    }

    /// Returns whether the mesh has quadrilaterals.
    #[inline(always)]
    pub(crate) fn has_quadrilaterals(&self) -> bool {
        !self.layout.corners.of_quadrilaterals().is_empty()
    }

    /// Returns whether the mean size of the elements, in the measure of the metrics, changes as vertices move. Target maps change
    /// the areas of triangles, and where triangles and quadrilaterals meet, an area counts more in the triangle.
    pub(crate) fn mean_varies(&self) -> bool {
        self.targets.is_some() || self.has_quadrilaterals() && !self.triangles().is_empty()
    }

    /// Returns the neighbors along edges of a free vertex, counter-clockwise.
    #[inline]
    pub(crate) fn neighbors(&self, vertex: u32) -> impl Iterator<Item = u32> + Clone + '_ {
        self.ring_of(vertex).iter().copied().filter(|&k| k & OPPOSITE == 0)
    }

    /// Returns all other vertices of the elements around a free vertex: neighbors along edges, and opposite vertices of
    /// quadrilaterals.
    #[inline]
    pub(crate) fn companions(&self, vertex: u32) -> impl Iterator<Item = u32> + Clone + '_ {
        self.ring_of(vertex).iter().map(|&k| k & !OPPOSITE)
    }

    /// Returns the corners that a free vertex has in the elements around it, counter-clockwise: its triangles, and three corners
    /// of each quadrilateral. Corners of quadrilaterals are marked true. Triangles and own corners start with the vertex.
    pub(crate) fn corners_around(
        &self,
        vertex: u32,
    ) -> impl Iterator<Item = ([u32; 3], bool)> + Clone + '_ {
        let ring = self.ring_of(vertex);
        let at = move |i: usize| ring[i % ring.len()];
        let neighbors = (0..ring.len()).filter(move |&i| at(i) & OPPOSITE == 0);
        neighbors.flat_map(move |i| {
            let (next, after) = (at(i), at(i + 1));
            let (list, count) = match after & OPPOSITE {
                0 => ([[vertex, next, after]; 3], 1),
                _ => {
                    let (opposite, last) = (after & !OPPOSITE, at(i + 2));
                    let own = [vertex, next, last];
                    ([own, [next, opposite, vertex], [last, vertex, opposite]], 3)
                }
            };
            list.into_iter().take(count).map(move |corner| (corner, count == 3))
        })
    }

    /// Returns the list of a free vertex in [`Self::ring`].
    #[inline]
    pub(crate) fn ring_of(&self, vertex: u32) -> &[u32] {
        &self.layout.ring[self.ring_range(vertex)]
    }

    /// Returns the range of [`Problem::ring`] that has the list of a free vertex.
    #[inline]
    pub(crate) fn ring_range(&self, vertex: u32) -> Range<usize> {
        let start = &self.layout.ring_start;
        start[vertex as usize] as usize..start[vertex as usize + 1] as usize
    }

    /// Returns all triangles, counter-clockwise, sorted by their least vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.layout.corners.triangles()
    }

    /// Returns all corners, counter-clockwise: the triangles, then four for each quadrilateral; see
    /// [`Topology`].
    pub(crate) fn corners(&self) -> &Corners<'static> {
        &self.layout.corners
    }

    /// Returns all corners by the kinds of their elements.
    pub(crate) fn corner_parts(&self) -> [CornerPart<'_>; 2] {
        let corners = &self.layout.corners;
        parts(corners.triangles(), corners.of_quadrilaterals())
    }

    /// Returns the corners of the elements over which the objective is the mean, by the kinds of their elements.
    pub(crate) fn judged_parts(&self) -> [CornerPart<'_>; 2] {
        parts(self.judged_triangles(), &self.judged_first_corners()[..self.judged.corner_count])
    }

    /// Returns the corners of the elements that are left out of the objective, by the kinds of their elements.
    pub(crate) fn unjudged_parts(&self) -> [CornerPart<'_>; 2] {
        let triangles = &self.judged_first()[self.judged.count..];
        parts(triangles, &self.judged_first_corners()[self.judged.corner_count..])
    }

    /// Returns the number of elements over which the objective is the mean.
    pub(crate) fn judged_count(&self) -> usize {
        self.judged.count + self.judged.corner_count / 4
    }

    /// Returns the triangles over which the objective is the mean: all triangles, or those of [`Self::judged_by_movable`].
    pub(crate) fn judged_triangles(&self) -> &[[u32; 3]] {
        &self.judged_first()[..self.judged.count]
    }

    /// Returns the quadrilaterals over which the objective is the mean, counter-clockwise.
    #[cfg(feature = "gpu")]
    pub(crate) fn judged_quadrilaterals(&self) -> Vec<[u32; 4]> {
        let corners = &self.judged_first_corners()[..self.judged.corner_count];
        // The corners of a quadrilateral follow each other, each with its own vertex first.
        let (quadrilaterals, _) = corners.as_chunks::<4>();
        quadrilaterals.iter().map(|corners| corners.map(|[own, ..]| own)).collect()
    }

    fn judged_first(&self) -> &[[u32; 3]] {
        self.judged.reordered.as_deref().unwrap_or_else(|| self.triangles())
    }

    fn judged_first_corners(&self) -> &[[u32; 3]] {
        let in_order = || self.layout.corners.of_quadrilaterals();
        self.judged.reordered_corners.as_deref().unwrap_or_else(in_order)
    }

    /// Returns the problem with an objective that is the mean over the elements with a vertex that is free or listed in
    /// `slides`, an ascending list. Other elements never change, and may be flatter than all others by orders of
    /// magnitude, for example in a boundary layer whose vertices are fixed. In a mean over all elements, their values
    /// would hide the gain of a run. If no element has such a vertex, the mean stays over all elements.
    pub(crate) fn judged_by_movable(&self, slides: &[u32]) -> Self {
        let is_judged =
            |&v: &u32| (v as usize) < self.free_count() || slides.binary_search(&v).is_ok();
        let is_judged = |corners: &[[u32; 3]]| corners.as_flattened().iter().any(is_judged);
        let (reordered, count) = judged_first(self.triangles(), 1, is_judged);
        let of_quadrilaterals = self.layout.corners.of_quadrilaterals();
        let (reordered_corners, corner_count) = judged_first(of_quadrilaterals, 4, is_judged);
        let judged = match count + corner_count {
            0 => Judged {
                reordered: None,
                count: self.triangles().len(),
                reordered_corners: None,
                corner_count: of_quadrilaterals.len(),
            },
            _ => Judged { reordered, count, reordered_corners, corner_count },
        };
        Self { judged, ..self.clone() }
    }

    /// Returns the target map of each vertex, in the order of the positions, `None` if the mesh has no targets.
    #[inline(always)]
    pub(crate) fn targets(&self) -> Option<&[[f32; 3]]> {
        self.targets.as_deref()
    }

    /// Returns whether the vertices have local maps.
    pub(crate) fn has_local_maps(&self) -> bool {
        self.local_maps.is_some()
    }

    /// Returns the map of each vertex whose coordinates Newton directions and coarser levels use, in the order of the
    /// positions: the local maps, else the target maps. `None` if the mesh has neither.
    #[inline(always)]
    pub(crate) fn maps(&self) -> Option<&[[f32; 3]]> {
        self.local_maps.as_deref().or(self.targets())
    }

    /// Returns the kind of maps that a device stores. The problem must have at most one kind of maps.
    #[cfg(feature = "gpu")]
    pub(crate) fn map_kind(&self) -> MapKind {
        debug_assert!(!self.is_for_cpu_alone());
        match (&self.targets, &self.local_maps) {
            (Some(_), _) => MapKind::Targets,
            (None, Some(_)) => MapKind::Local,
            (None, None) => MapKind::None,
        }
    }

    /// Bounds the free vertices. [`Problem::positions`] are the centers of the discs.
    pub(crate) fn set_bounds(&mut self, bounds: Bounds) {
        self.bounds =
            (bounds.radii.is_some() || bounds.least_altitude > 0.0).then(|| Arc::new(bounds));
    }

    /// Returns whether discs or a least altitude bound the free vertices.
    pub(crate) fn is_bounded(&self) -> bool {
        self.bounds.is_some()
    }

    /// Returns the radius of the disc of each free vertex, `None` without discs.
    pub(crate) fn radii(&self) -> Option<&[f64]> {
        self.bounds.as_ref()?.radii.as_deref()
    }

    /// Returns the lower limit of altitudes, 0 for no limit.
    pub(crate) fn least_altitude(&self) -> f64 {
        self.bounds.as_ref().map_or(0.0, |bounds| bounds.least_altitude)
    }

    /// Returns whether the vertices have both target maps and local maps, for which a device has no room, or bounds in the
    /// coordinates of a sphere, which single precision does not test.
    pub(crate) fn is_for_cpu_alone(&self) -> bool {
        let has_two_maps = self.targets.is_some() && self.local_maps.is_some();
        has_two_maps || self.is_bounded() && self.projection.is_some()
    }

    /// Returns whether some map of the vertices is anisotropic. Coarse levels then work in coordinates transformed by
    /// the maps, in which neighbors across a layer are as near as neighbors along the layer.
    pub(crate) fn is_stretched(&self) -> bool {
        self.has_local_maps() || self.has_stretched_targets
    }

    /// Returns whether coarse levels work in the coordinates of the plane, whatever the maps are.
    pub(crate) fn are_levels_in_plane(&self) -> bool {
        self.levels_in_plane
    }

    /// Lets coarse levels work in the coordinates of the plane, also after the maps have changed. Where the maps of
    /// neighbors differ much, a translation of these neighbors is no constant in the coordinates of the maps, and the
    /// levels take large changes of triangles for translations.
    pub(crate) fn set_levels_in_plane(&mut self) {
        self.levels_in_plane = true;
    }

    /// Returns a triangle in the form of the metrics, transformed by its target map if the mesh has targets.
    #[inline(always)]
    pub(crate) fn corner(&self, t: &[u32; 3], position: impl Fn(u32) -> DVec2) -> Corner<f64> {
        self.corner_of(false, t, position)
    }

    /// Returns a corner in the form of the metrics, transformed by its target map if the mesh has targets. `is_right` tells
    /// whether the corner is of a quadrilateral.
    #[inline(always)]
    pub(crate) fn corner_of(
        &self,
        is_right: bool,
        t: &[u32; 3],
        position: impl Fn(u32) -> DVec2,
    ) -> Corner<f64> {
        let [p, q, r] = t.map(position);
        let mut corner = Corner { a: (q - p).into(), b: (r - p).into(), ideal: self.ideal() };
        if is_right {
            corner = corner.of_right_angle();
        }
        match self.target_map(t) {
            None => corner,
            Some(map) => map.transform(&corner),
        }
    }

    /// Returns the target map of a triangle, the mean over its vertices, or `None` if the mesh has no targets.
    #[inline(always)]
    pub(crate) fn target_map(&self, t: &[u32; 3]) -> Option<TargetMap<f64>> {
        let maps = self.targets()?;
        Some(TargetMap::mean(t.map(|v| maps[v as usize].map(f64::from))))
    }

    /// Returns the mean area of triangles in normalized units, after target maps are applied if the mesh has any.
    pub fn mean_area(&self) -> f64 {
        self.ideal.area
    }

    /// Returns the ideal triangle of the metrics in normalized units.
    #[inline(always)]
    pub(crate) fn ideal(&self) -> Ideal {
        // The constant lets the compiler leave the code for right angles out of loops over triangles.
        Ideal { is_right: false, ..self.ideal }
    }

    /// Returns the index in the mesh of each vertex of the problem.
    pub fn vertices(&self) -> &[u32] {
        &self.layout.vertices
    }

    /// Returns the index in the problem of each vertex of the mesh, which has `count` vertices. `u32::MAX` stands for a
    /// vertex that no triangle uses.
    pub(crate) fn numbers(&self, count: usize) -> Vec<u32> {
        let mut numbers = vec![u32::MAX; count];
        for (new, &v) in (0..).zip(self.vertices()) {
            numbers[v as usize] = new;
        }
        numbers
    }

    /// Returns the corners for which the inverse mean ratio or its square overflows, computed in double precision
    /// from any of their three vertices. Metrics with a barrier cannot judge them: they are too flat, or too small beside
    /// other elements.
    pub(crate) async fn beyond_precision(&self, positions: &[DVec2]) -> Vec<u32> {
        let position = |v: u32| positions[v as usize];
        let is_beyond = |&[p, q, r]: &[u32; 3]| {
            [[p, q, r], [q, r, p], [r, p, q]].iter().any(|turned| {
                let ratio = self.corner(turned, position).inverse_mean_ratio();
                !(ratio * ratio).is_finite()
            })
        };
        let found =
            paced::map_parts(self.layout.corners.all().chunks(CHUNK), |chunk, part| -> Vec<u32> {
                let beyond = part.iter().zip(chunk * CHUNK..).filter(|(t, _)| is_beyond(t));
                beyond.map(|(_, t)| t as u32).collect()
            });
        found.await.concat()
    }

    /// Returns the corners of the mesh, in ascending order, that are the listed corners of the problem. `given` is the topology of
    /// the mesh.
    pub(crate) fn in_mesh(&self, corners: &[u32], given: &Topology<'_>) -> Vec<u32> {
        if corners.is_empty() {
            return Vec::new();
        }
        let sorted = |mut vertices: [u32; 3]| {
            vertices.sort_unstable();
            vertices
        };
        let all = self.layout.corners.all();
        let of = |&c: &u32| sorted(all[c as usize].map(|v| self.layout.vertices[v as usize]));
        let sought: HashSet<[u32; 3]> = corners.iter().map(of).collect();
        let all = (0..).zip(given.corners());
        all.filter(|&(_, &c)| sought.contains(&sorted(c))).map(|(corner, _)| corner).collect()
    }
}

fn parts<'p>(triangles: &'p [[u32; 3]], of_quadrilaterals: &'p [[u32; 3]]) -> [CornerPart<'p>; 2] {
    [
        CornerPart { corners: triangles, is_right: false },
        CornerPart { corners: of_quadrilaterals, is_right: true },
    ]
}

/// Returns a list of corners with those of judged elements first, and the number of the latter. Elements have `size` corners
/// each. The list is `None` if the judged elements come first in `corners`.
fn judged_first(
    corners: &[[u32; 3]],
    size: usize,
    is_judged: impl Fn(&[[u32; 3]]) -> bool,
) -> (Option<Arc<[[u32; 3]]>>, usize) {
    // Free vertices have the lowest numbers, so in most lists all judged elements come first.
    let first = corners.chunks_exact(size).take_while(|element| is_judged(element)).count();
    let (first, rest) = corners.split_at(size * first);
    let (judged, others): (Vec<&[[u32; 3]]>, Vec<_>) =
        rest.chunks_exact(size).partition(|element| is_judged(element));
    let count = first.len() + size * judged.len();
    let is_in_order = judged.is_empty();
    let rest = judged.into_iter().chain(others).flatten();
    ((!is_in_order).then(|| first.iter().chain(rest).copied().collect()), count)
}
