//! A mesh with the vertices that stay, the lines along which vertices slide, and the surface of its coordinates.

use std::borrow::Cow;

use gpu_smooth::front_ends::{Chart, Plane, select};
use gpu_smooth::layers::{Elements, KeepLayers, Layers};
use gpu_smooth::options::Precision;
use gpu_smooth::slide::Periodic;
use gpu_smooth::{Mesh, MeshError, Slide, Topology};
use mesh_io::{
    Affine, Constraints, MeshFile, edges_between_regions, interface_vertices, interfaces,
};

/// A mesh with the vertices that stay, the lines along which vertices slide, and the surface of its coordinates, from the
/// facts of a file or of an application. Options of a run then fix further vertices.
#[derive(Clone, Debug, Default)]
pub struct Domain {
    /// The mesh to smooth. Its fixed vertices are those on constraints and those that options fix, followed by
    /// `interfaces`; each is listed once.
    mesh: Mesh,
    /// Vertices fixed only because they lie between regions, ascending.
    interfaces: Vec<u32>,
    /// Vertices between regions, also those fixed for another reason, ascending. Empty after
    /// [`free_interfaces`](Self::free_interfaces).
    between_regions: Vec<u32>,
    /// Edges between regions. Empty after [`free_interfaces`](Self::free_interfaces).
    interface_edges: Vec<[u32; 2]>,
    has_free_interfaces: bool,
    has_free_lines: bool,
    /// Whether vertices of quadrilaterals move.
    moves_quadrilaterals: bool,
    /// Vertices that neither move nor slide. In any order, with repeats.
    anchored: Vec<u32>,
    /// Edges of lines, between which vertices slide. Empty after [`free_lines`](Self::free_lines).
    lines: Vec<[u32; 2]>,
    periodic: Vec<Periodic>,
    /// Motions of periodic models without pairs.
    motions: Vec<Affine>,
    weirs: Vec<Vec<[u32; 2]>>,
    has_unread_pairs: bool,
    /// The mesh with continued longitudes; `None` if no triangle crosses the date line or touches a pole.
    chart: Option<Chart>,
    /// The plane of the mesh; `None` if all z are equal, or z is data.
    plane: Option<Plane>,
    /// Whether all vertices stay, as only those near bad triangles may move, and no triangle is bad.
    keeps_all: bool,
}

/// How vertices slide along lines; see [`Domain::curves`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SlideBy {
    /// The smallest turn of a line, in degrees, at a corner. Vertices at corners stay.
    pub corner_angle: f64,
    /// Largest distance of lines from those of the mesh before the run, in the unit of the mesh. `None` stands for a tenth of
    /// the local edge length.
    pub hausdorff: Option<f64>,
    /// Pairs of boundary sides, by their vertices, which slide together.
    pub sides: Vec<[Vec<u32>; 2]>,
    /// Vertices that stay because groups of the file end there; see [`MeshFile::group_ends`].
    pub ends: Vec<u32>,
}

impl Default for SlideBy {
    fn default() -> Self {
        let Slide { corner_angle, hausdorff, .. } = Slide::default();
        Self { corner_angle, hausdorff, sides: Vec::new(), ends: Vec::new() }
    }
}

/// The curves along which the vertices of a domain slide.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Curves {
    /// Lines, held vertices and pairs, for [`Smoother::set_slide`](gpu_smooth::Smoother::set_slide).
    pub slide: Slide,
    /// Whether the boundary stays because the model is periodic and no pair of vertices is known.
    pub has_lost_pairs: bool,
    /// Index of the first pair in [`SlideBy::sides`] of whose sides no translation or rotation maps one to the other.
    pub unlike_sides: Option<usize>,
}

/// The effect of [`Domain::fix_far_from_bad`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct NearBad {
    /// Number of bad triangles and quadrilaterals.
    pub elements: usize,
    /// Number of free vertices afterwards and before.
    pub free: [usize; 2],
}

impl Domain {
    /// Makes the domain of the triangles of a file. Vertices that the file constrains and vertices between regions are fixed, and
    /// so are all vertices of quadrilaterals.
    pub fn of_file(file: &MeshFile) -> Self {
        let Constraints {
            vertices,
            lines,
            anchored,
            periodic,
            weirs,
            motions,
            has_unread_pairs,
            ..
        } = file.constraints();
        let pairs = periodic.iter();
        let pairs = pairs.map(|p| Periodic { pairs: p.pairs.clone(), motion: p.motion });
        let (points, triangles) = (file.points().to_vec(), file.triangles().to_vec());
        Self {
            anchored: anchored.clone(),
            lines: lines.clone(),
            interface_edges: file.interface_edges(),
            periodic: pairs.collect(),
            motions: motions.clone(),
            weirs: weirs.clone(),
            has_unread_pairs: *has_unread_pairs,
            ..Self::with(points, triangles, vertices.clone(), file.interface_vertices())
        }
    }

    /// Makes the domain of a file as [`of_file`](Self::of_file) does, but with its quadrilaterals in the mesh. Their vertices may
    /// move, unless they are fixed for another reason. A quadrilateral that lists a vertex twice is no element, and its vertices
    /// stay.
    pub fn of_elements(file: &MeshFile) -> Self {
        let Constraints { vertices, anchored, .. } = file.constraints_beside_quadrilaterals();
        let (interfaces, interface_edges) = file.interfaces_of_elements();
        let of_triangles = Self::of_file(file);
        let quadrilaterals = file.proper_quadrilaterals().map(|(_, &corners)| corners).collect();
        let Mesh { points, triangles, .. } = of_triangles.mesh;
        let Self { mesh, interfaces, between_regions, .. } =
            Self::with(points, triangles, vertices, interfaces);
        Self {
            mesh: Mesh { quadrilaterals, ..mesh },
            interfaces,
            between_regions,
            interface_edges,
            anchored,
            moves_quadrilaterals: true,
            ..of_triangles
        }
    }

    /// Fixes all vertices of quadrilaterals of the domain that [`of_elements`](Self::of_elements) made of `file`, so that the
    /// mesh has triangles alone, as by [`of_file`](Self::of_file). Vertices that were fixed or freed stay so.
    pub fn keep_quadrilaterals(&mut self, file: &MeshFile) {
        if !self.moves_quadrilaterals {
            return;
        }
        let of_elements = std::mem::replace(self, Self::of_file(file));
        if of_elements.has_free_lines {
            self.free_lines();
        }
        if of_elements.has_free_interfaces {
            self.free_interfaces();
        }
        if let Some(chart) = &of_elements.chart {
            self.set_chart(chart.clone());
        }
        // All vertices that the file anchors beside quadrilaterals are anchored here too.
        let mut held = vec![false; self.mesh.points.len()];
        of_elements.anchored.iter().for_each(|&vertex| held[vertex as usize] = true);
        self.hold(held);
        self.mesh.points = of_elements.mesh.points;
        self.periodic = of_elements.periodic;
        self.plane = of_elements.plane;
        self.keeps_all = of_elements.keeps_all;
    }

    /// Returns whether vertices of quadrilaterals move.
    pub fn moves_quadrilaterals(&self) -> bool {
        self.moves_quadrilaterals
    }

    /// Returns the vertices inside the mesh at which elements of different regions meet, also those fixed for another reason,
    /// ascending. Empty after [`free_interfaces`](Self::free_interfaces).
    pub fn between_regions(&self) -> &[u32] {
        &self.between_regions
    }

    /// Makes the domain of a mesh. The vertices of `lines` and inner vertices between different `regions` of the elements are
    /// fixed, and may slide along these edges, as in [`Self::of_elements`]. `regions` are those of the triangles, then those of the
    /// quadrilaterals; without regions, the list is empty. The fixed vertices of the mesh neither move nor slide.
    ///
    /// # Panics
    /// Panics if an element has a vertex that does not exist, and if there are regions, or if a fixed vertex does not exist.
    pub fn of_mesh(mesh: Mesh, lines: Vec<[u32; 2]>, regions: &[i64]) -> Self {
        let Mesh { points, triangles, quadrilaterals, fixed: held } = mesh;
        let (between, interface_edges) = match quadrilaterals.is_empty() {
            true => (
                interface_vertices(regions, &triangles, points.len()),
                edges_between_regions(regions, &triangles, points.len()),
            ),
            false => {
                let of_triangles = triangles.iter().map(|corners| &corners[..]);
                let all = of_triangles.chain(quadrilaterals.iter().map(|corners| &corners[..]));
                interfaces(all.zip(regions.iter().copied()), points.len())
            }
        };
        let fixed = lines.as_flattened().to_vec();
        let mut domain = Self::with(points, triangles, fixed, between);
        domain.moves_quadrilaterals = !quadrilaterals.is_empty();
        domain.mesh.quadrilaterals = quadrilaterals;
        (domain.lines, domain.interface_edges) = (lines, interface_edges);
        if !held.is_empty() {
            let mut is_held = vec![false; domain.mesh.points.len()];
            held.iter().for_each(|&vertex| is_held[vertex as usize] = true);
            domain.hold(is_held);
        }
        domain
    }

    fn with(
        points: Vec<[f64; 2]>,
        triangles: Vec<[u32; 3]>,
        mut fixed: Vec<u32>,
        mut interfaces: Vec<u32>,
    ) -> Self {
        fixed.sort_unstable();
        fixed.dedup();
        let between_regions = interfaces.clone();
        interfaces.retain(|v| fixed.binary_search(v).is_err());
        fixed.extend_from_slice(&interfaces);
        let mesh = Mesh { points, triangles, fixed, ..Mesh::default() };
        Self { mesh, interfaces, between_regions, ..Self::default() }
    }

    /// Adds pairs of vertices that slide together.
    pub fn pair(&mut self, pairs: Vec<[u32; 2]>) {
        self.periodic.push(Periodic { pairs, motion: None });
    }

    /// Returns the mesh to smooth, with the vertices that stay. Copies of vertices, made by the chart, follow the others.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Moves the mesh out of the domain, whose mesh is then empty.
    pub fn take_mesh(&mut self) -> Mesh {
        self.interfaces = Vec::new();
        std::mem::take(&mut self.mesh)
    }

    /// Replaces the points of the mesh, as untangling does. Returns the points before.
    pub fn replace_points(&mut self, points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        std::mem::replace(&mut self.mesh.points, points)
    }

    /// Returns the mesh with continued longitudes; `None` if longitudes are not continued.
    pub fn chart(&self) -> Option<&Chart> {
        self.chart.as_ref()
    }

    /// Returns the plane of the mesh; `None` if all z are equal, or z is data.
    pub fn plane(&self) -> Option<&Plane> {
        self.plane.as_ref()
    }

    /// Returns whether the mesh lies in the plane of x and y.
    pub fn is_in_xy(&self) -> bool {
        self.plane().is_none_or(Plane::is_of_xy)
    }

    /// Returns the vertices fixed only because they lie between regions, ascending. After
    /// [`free_interfaces`](Self::free_interfaces), the list is empty.
    pub fn interface_vertices(&self) -> &[u32] {
        &self.interfaces
    }

    /// Returns the vertices that neither move nor slide.
    pub fn anchored(&self) -> &[u32] {
        &self.anchored
    }

    /// Returns the edges along which vertices inside the mesh may slide: lines, and edges between regions. Edges between
    /// regions are omitted after [`free_interfaces`](Self::free_interfaces), lines after [`free_lines`](Self::free_lines).
    pub fn lines(&self) -> Vec<[u32; 2]> {
        [&self.lines[..], &self.interface_edges].concat()
    }

    /// Lets vertices between regions move, unless they are fixed for another reason.
    pub fn free_interfaces(&mut self) {
        self.has_free_interfaces = true;
        self.interface_edges = Vec::new();
        self.between_regions = Vec::new();
        let held = std::mem::take(&mut self.interfaces);
        self.mesh.fixed.truncate(self.mesh.fixed.len() - held.len());
    }

    /// Returns whether vertices between regions are fixed because they lie there.
    pub fn holds_interfaces(&self) -> bool {
        !self.has_free_interfaces
    }

    /// Lets vertices on lines inside of the mesh move, and on curves of the model of a file, unless they are fixed for another
    /// reason. Vertices then slide along the boundary and between regions alone.
    pub fn free_lines(&mut self) {
        self.has_free_lines = true;
        self.lines = Vec::new();
        let mut stays = vec![false; self.mesh.points.len()];
        self.anchored.iter().for_each(|&vertex| stays[vertex as usize] = true);
        let fixed = &mut self.mesh.fixed;
        fixed.truncate(fixed.len() - self.interfaces.len());
        fixed.retain(|&vertex| stays[vertex as usize]);
        self.interfaces.clone_from(&self.between_regions);
        self.interfaces.retain(|&vertex| !stays[vertex as usize]);
        fixed.extend_from_slice(&self.interfaces);
    }

    /// Returns whether vertices on lines are fixed because they lie there.
    pub fn holds_lines(&self) -> bool {
        !self.has_free_lines
    }

    /// Lays the mesh out in a plane of space: its points are positions in the plane.
    pub fn set_plane(&mut self, plane: Option<Plane>) {
        if let Some(plane) = &plane {
            self.mesh.points = plane.points().to_vec();
        }
        self.plane = plane;
    }

    /// Interprets coordinates as longitude and latitude in degrees, and continues longitudes across the meridian at which they
    /// wrap. `stored` is the precision of the coordinates.
    ///
    /// # Errors
    /// The errors of [`Chart::new`]. The mesh is then unchanged.
    pub fn lay_out_on_sphere(&mut self, stored: Precision) -> Result<(), MeshError> {
        if self.chart.is_none()
            && let Some(chart) = Chart::new(&self.mesh, stored)?
        {
            self.set_chart(chart);
        }
        Ok(())
    }

    /// Lays the mesh out with continued longitudes. Vertices that the chart holds neither move nor slide.
    pub fn set_chart(&mut self, chart: Chart) {
        let Mesh { points, triangles, quadrilaterals, .. } = chart.mesh();
        self.mesh.points.clone_from(points);
        self.mesh.triangles.clone_from(triangles);
        if self.moves_quadrilaterals {
            self.mesh.quadrilaterals.clone_from(quadrilaterals);
        }
        let mut held = vec![false; points.len()];
        chart.held().iter().for_each(|&vertex| held[vertex as usize] = true);
        self.hold(held);
        self.chart = Some(chart);
    }

    /// Converts points of the mesh to x and y as given, without copies and with longitudes in the given range.
    pub fn given<'p>(&self, points: &'p [[f64; 2]]) -> Cow<'p, [[f64; 2]]> {
        if let Some(plane) = self.plane().filter(|plane| !plane.is_of_xy()) {
            return plane.in_space(points).iter().map(|&[x, y, _]| [x, y]).collect();
        }
        match self.chart() {
            // Writers refuse lists of any other length.
            Some(chart) if points.len() == self.mesh.points.len() => chart.given(points).into(),
            _ => points.into(),
        }
    }

    /// Fixes `vertices`, so that they neither move nor slide. The list may be unordered and have repeats.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if a vertex does not exist. The domain is then unchanged.
    pub fn fix(&mut self, vertices: &[u32]) -> Result<(), MeshError> {
        let held = self.marked(vertices)?;
        self.hold(held);
        Ok(())
    }

    /// Fixes the vertices that are far from bad elements, those with an inverse mean ratio above `limit`. Vertices within
    /// `rings` rings of elements around a bad element are near. Without a bad element, [`Self::layers`] has all vertices, so
    /// that runs end before the first sweep.
    ///
    /// # Errors
    /// [`MeshError`] if the mesh cannot be smoothed; see [`Topology::new`].
    pub fn fix_far_from_bad(&mut self, limit: f64, rings: u32) -> Result<NearBad, MeshError> {
        let topology = Topology::new(self.mesh())?;
        let bad = select::corners_above(&self.mesh().points, &topology, limit);
        let near = select::vertices_near(&topology, &bad, rings);
        let is_free = |vertex: &&u32| topology.free()[**vertex as usize];
        let free = [near.iter().filter(is_free).count(), topology.free_count()];
        let elements = topology.elements(&bad).len();
        drop(topology);
        match bad.is_empty() {
            true => self.keeps_all = true,
            false => self.fix_all_but(&near)?,
        }
        Ok(NearBad { elements, free })
    }

    /// Returns whether all vertices stay, because [`Self::fix_far_from_bad`] has found no bad triangle.
    pub fn keeps_all(&self) -> bool {
        self.keeps_all
    }

    /// Fixes all vertices except `vertices`. A listed vertex stays fixed if it was fixed before.
    ///
    /// # Errors
    /// [`MeshError::IndexOutOfRange`] if a vertex does not exist. The domain is then unchanged.
    pub fn fix_all_but(&mut self, vertices: &[u32]) -> Result<(), MeshError> {
        let mut held = self.marked(vertices)?;
        held.iter_mut().for_each(|held| *held = !*held);
        self.hold(held);
        Ok(())
    }

    /// Returns a mask of the mesh's vertices, true for each entry of `vertices`.
    fn marked(&self, vertices: &[u32]) -> Result<Vec<bool>, MeshError> {
        let count = self.mesh.points.len();
        let mut marked = vec![false; count];
        for &vertex in vertices {
            *marked.get_mut(vertex as usize).ok_or(MeshError::IndexOutOfRange {
                element: None,
                vertex,
                vertices: count,
            })? = true;
        }
        Ok(marked)
    }

    /// Fixes the vertices of the mask `held`, also those between regions.
    fn hold(&mut self, mut held: Vec<bool>) {
        let all = (0..).zip(&held).filter(|&(_, &held)| held);
        self.anchored.extend(all.map(|(vertex, _)| vertex));
        let fixed = &mut self.mesh.fixed;
        fixed.truncate(fixed.len() - self.interfaces.len());
        self.interfaces.retain(|&vertex| !held[vertex as usize]);
        fixed.iter().for_each(|&vertex| held[vertex as usize] = false);
        fixed.extend((0..).zip(held).filter(|&(_, held)| held).map(|(vertex, _)| vertex));
        fixed.extend_from_slice(&self.interfaces);
    }

    /// Finds the boundary layers that `keep` names. Walls are the boundary, the lines, and edges between regions, or the
    /// vertices `walls` if given. `faces` are the [`faces_beside_mesh`](Self::faces_beside_mesh). The layers have all
    /// vertices if [`keeps_all`](Self::keeps_all) holds.
    ///
    /// # Errors
    /// [`MeshError`] if `walls` has a vertex that does not exist.
    pub fn layers(
        &self,
        topology: &Topology<'_>,
        keep: KeepLayers,
        walls: Option<&[u32]>,
        faces: &[Vec<u32>],
    ) -> Result<Layers, MeshError> {
        let (points, lines) = (&self.mesh.points, &self.lines());
        if self.keeps_all {
            let vertices = (0..points.len() as u32).collect();
            return Ok(Layers { vertices, ..Layers::default() });
        }
        keep.find(&Elements { topology, points, faces, lines }, walls)
    }

    /// Returns the quadrilaterals and polygons of a file that are no elements of the mesh, as lists of vertices: all
    /// [`other_faces`](MeshFile::other_faces), without the quadrilaterals if their vertices move.
    pub fn faces_beside_mesh(&self, file: &MeshFile) -> Vec<Vec<u32>> {
        let is_beside = |face: &&[u32]| !(self.moves_quadrilaterals && face.len() == 4);
        file.other_faces().filter(is_beside).map(<[u32]>::to_vec).collect()
    }

    /// Returns the curves along which vertices slide, with the vertices at `points`, by the topology of the
    /// [`mesh`](Self::mesh).
    pub fn curves(&self, points: &[[f64; 2]], topology: &Topology<'_>, by: &SlideBy) -> Curves {
        let SlideBy { corner_angle, hausdorff, sides, ends } = by;
        let mut lines = self.lines();
        // Vertices on lines of the boundary are fixed, and slide along the boundary.
        let boundary = topology.boundary_edges();
        lines.extend_from_slice(&boundary);
        // Motions of files are motions in x and y.
        let motion = |motion| if self.is_in_xy() { motion } else { None };
        let pairs = self.periodic.iter();
        let pairs = pairs.map(|p| Periodic { pairs: p.pairs.clone(), motion: motion(p.motion) });
        let mut slide = Slide {
            corner_angle: *corner_angle,
            hausdorff: *hausdorff,
            lines,
            held: self.anchored.clone(),
            periodic: pairs.collect(),
        };
        slide.pair_banks(topology, points, &self.weirs);
        for &motion in self.motions.iter().filter(|_| self.is_in_xy()) {
            slide.pair_by(topology, points, motion);
        }
        let mut pairs = |[a, b]: &[Vec<u32>; 2]| slide.pair_sides(topology, points, [a, b]);
        let unlike_sides = sides.iter().position(|sides| pairs(sides) == 0);
        let is_periodic = self.has_unread_pairs || !self.motions.is_empty();
        let has_lost_pairs = is_periodic && slide.periodic.is_empty();
        if has_lost_pairs {
            slide.held.extend(boundary.into_iter().flatten());
        }
        slide.held.extend_from_slice(ends);
        Curves { slide, has_lost_pairs, unlike_sides }
    }
}

#[cfg(test)]
mod tests;
