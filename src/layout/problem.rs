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
use crate::layout::numbering::{order, rings, triangles};
use crate::layout::placement::{Placement, sum};
use crate::mesh::Mesh;
use crate::metric::{Corner, Ideal, TargetMap};
use crate::parallel::counting_sort::{atomics, plain};
use crate::parallel::{collect, for_each_part, paced};
use crate::targets::Targets;
use crate::topology::Topology;

/// Number of vertices or triangles that one task handles.
const CHUNK: usize = 1 << 12;

/// A mesh laid out for sweeping. Vertices are renumbered: first the free vertices, color by color, then the fixed
/// vertices that some triangle uses. The vertices of a color are in blocks along a space-filling curve, and within a
/// block they are ordered by the number of their neighbors.
///
/// Positions are scaled by a power of two so that the mean area of the triangles is in [0.5, 2], and the center of a
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
    /// Triangles over whose squared qualities the objective is the mean: all triangles, or those that can move.
    judged: Judged,
    /// Bounds on the free vertices. `None` without bounds.
    pub(super) bounds: Option<Arc<Bounds>>,
}

/// The triangles over which the objective is the mean: the first `count` of a list.
#[derive(Clone, Debug)]
struct Judged {
    /// All triangles, with the judged triangles first. `None` if the list of the layout begins with them.
    reordered: Option<Arc<[[u32; 3]]>>,
    count: usize,
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
    triangles: Vec<[u32; 3]>,
    pub(super) vertices: Vec<u32>,
}

impl Problem {
    /// Lays out a mesh with its topology and coloring.
    pub fn new(mesh: &Mesh, topology: &Topology<'_>, coloring: &Coloring) -> Self {
        Self::along(mesh, topology, coloring, &along_curve(mesh, topology))
    }

    /// Lays out a mesh as [`Self::new`] does. `curve` lists the vertices that some triangle uses, in the order of a
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
        let triangles = triangles(topology, vertices.len(), &number);
        drop(number);
        let layout = Layout { colors, ring_start, ring, triangles, vertices };
        Self::placed(Arc::new(layout), mesh, topology)
    }

    /// Returns the problem of a mesh with other points. Colors, one-rings, triangles and the order of vertices are shared with
    /// this problem. The returned problem has neither projection nor maps nor bounds, and is judged by all triangles.
    pub(crate) fn at_points(&self, mesh: &Mesh, topology: &Topology<'_>) -> Self {
        Self::placed(Arc::clone(&self.layout), mesh, topology)
    }

    fn placed(layout: Arc<Layout>, mesh: &Mesh, topology: &Topology<'_>) -> Self {
        let (placement, mean_area) =
            Placement::of(mesh, topology, &layout.vertices, &layout.triangles);
        let judged = Judged { reordered: None, count: layout.triangles.len() };
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
    /// maps so that the mean area of the triangles, after their maps are applied, is 1.
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
        let scale =
            (sum(&self.layout.triangles, area) / self.layout.triangles.len() as f64).sqrt().recip();
        let scaled = |v: u32| map(v).map(|x| (x * scale) as f32);
        let maps = collect(self.layout.vertices.len(), |i| scaled(self.layout.vertices[i]));
        let is_longer = |&[xx, xy, yy]: &[f32; 3]| xx != yy || xy != 0.0;
        self.has_stretched_targets = maps.iter().any(is_longer);
        self.targets = Some(maps.into());
        let transformed_area =
            |t: &[u32; 3]| 0.5 * self.corner(t, |v| positions[v as usize]).doubled_area();
        self.ideal = Ideal {
            area: sum(&self.layout.triangles, transformed_area)
                / self.layout.triangles.len() as f64,
            size_weight: targets.size_weight(),
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

    /// Returns the neighbors of all free vertices, vertex by vertex, counter-clockwise around each vertex.
    pub fn ring(&self) -> &[u32] {
        &self.layout.ring
    }

    /// Returns the neighbors of a free vertex, counter-clockwise.
    #[inline]
    pub(crate) fn ring_of(&self, vertex: u32) -> &[u32] {
        &self.layout.ring[self.ring_range(vertex)]
    }

    /// Returns the range of [`Problem::ring`] that has the neighbors of a free vertex.
    #[inline]
    pub(crate) fn ring_range(&self, vertex: u32) -> Range<usize> {
        let start = &self.layout.ring_start;
        start[vertex as usize] as usize..start[vertex as usize + 1] as usize
    }

    /// Returns all triangles, counter-clockwise, sorted by their least vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.layout.triangles
    }

    /// Returns the triangles over which the objective is the mean: all triangles, or those of [`Self::judged_by_movable`].
    pub(crate) fn judged_triangles(&self) -> &[[u32; 3]] {
        &self.judged_first()[..self.judged.count]
    }

    /// Returns the triangles that are left out of the objective.
    pub(crate) fn unjudged_triangles(&self) -> &[[u32; 3]] {
        &self.judged_first()[self.judged.count..]
    }

    fn judged_first(&self) -> &[[u32; 3]] {
        self.judged.reordered.as_deref().unwrap_or_else(|| self.triangles())
    }

    /// Returns the problem with an objective that is the mean over the triangles with a corner that is free or listed in
    /// `slides`, an ascending list. Other triangles never change, and may be flatter than all others by orders of
    /// magnitude, for example in a boundary layer whose vertices are fixed. In a mean over all triangles, their values
    /// would hide the gain of a run. If no triangle has such a corner, the mean stays over all triangles.
    pub(crate) fn judged_by_movable(&self, slides: &[u32]) -> Self {
        // Free vertices have the lowest numbers, so the triangles with a free corner come first in the list of the layout.
        let free = self.triangles().partition_point(|t| self.can_move(t));
        let slides_along = |t: &&[u32; 3]| t.iter().any(|v| slides.binary_search(v).is_ok());
        let (first, others) = self.triangles().split_at(free);
        let (sliding, still): (Vec<&[u32; 3]>, _) = others.iter().partition(slides_along);
        let is_in_order = sliding.is_empty() || still.is_empty();
        let reordered = (!is_in_order)
            .then(|| first.iter().chain(sliding.iter().copied()).chain(still).copied().collect());
        let count = match free + sliding.len() {
            0 => self.triangles().len(),
            count => count,
        };
        Self { judged: Judged { reordered, count }, ..self.clone() }
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
        self.bounds = (bounds.radii.is_some() || bounds.floor > 0.0).then(|| Arc::new(bounds));
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
    pub(crate) fn floor(&self) -> f64 {
        self.bounds.as_ref().map_or(0.0, |bounds| bounds.floor)
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
        let [p, q, r] = t.map(position);
        let corner = Corner { a: (q - p).into(), b: (r - p).into(), ideal: self.ideal };
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

    /// Returns the mean area of all triangles in normalized units, after target maps are applied if the mesh has any.
    pub fn mean_area(&self) -> f64 {
        self.ideal.area
    }

    /// Returns the ideal triangle of the metrics in normalized units.
    #[inline(always)]
    pub(crate) fn ideal(&self) -> Ideal {
        self.ideal
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

    /// Returns the triangles for which the inverse mean ratio or its square overflows, computed in double precision
    /// from any of the three corners. Metrics with a barrier cannot judge them: they are too flat, or too small beside
    /// other triangles.
    pub(crate) async fn beyond_precision(&self, positions: &[DVec2]) -> Vec<u32> {
        let position = |v: u32| positions[v as usize];
        let is_beyond = |&[p, q, r]: &[u32; 3]| {
            [[p, q, r], [q, r, p], [r, p, q]].iter().any(|turned| {
                let ratio = self.corner(turned, position).inverse_mean_ratio();
                !(ratio * ratio).is_finite()
            })
        };
        let found =
            paced::map_parts(self.layout.triangles.chunks(CHUNK), |chunk, part| -> Vec<u32> {
                let beyond = part.iter().zip(chunk * CHUNK..).filter(|(t, _)| is_beyond(t));
                beyond.map(|(_, t)| t as u32).collect()
            });
        found.await.concat()
    }

    /// Returns the indices in the mesh, in ascending order, of the listed triangles. `given` are all triangles of the
    /// mesh.
    pub(crate) fn in_mesh(&self, triangles: &[u32], given: &[[u32; 3]]) -> Vec<usize> {
        if triangles.is_empty() {
            return Vec::new();
        }
        let sorted = |mut vertices: [u32; 3]| {
            vertices.sort_unstable();
            vertices
        };
        let of = |&t: &u32| {
            sorted(self.layout.triangles[t as usize].map(|v| self.layout.vertices[v as usize]))
        };
        let sought: HashSet<[u32; 3]> = triangles.iter().map(of).collect();
        (0..given.len()).filter(|&t| sought.contains(&sorted(given[t]))).collect()
    }
}
