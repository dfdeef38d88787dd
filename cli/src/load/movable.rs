//! Selection of the movable vertices of a mesh.

use std::collections::HashSet;

use crate::error::CliError;
use crate::load::LoadedMesh;
use gpu_smooth::{DetachedTopology, Element, Topology, front_ends::select};

use crate::load::explain;
use crate::load::layers::keep_layers;
use crate::load::named::{named, refusal};
use crate::request::{MovableRequest, NearBad, SlideRequest};
use crate::terminal::numbers::{counted, sig6};

/// The effect on a mesh of the options that select movable vertices.
#[derive(Default)]
pub(crate) struct MovableSelection {
    /// A line for each option, with the number of vertices that the option fixes or frees.
    pub(crate) notes: Vec<String>,
    /// Number of vertices that could move without `--fix…` and `--only…`; 0 if the command line has neither.
    free_without: usize,
    /// Vertices that boundary layers alone fix, ascending.
    pub(crate) layers: Vec<u32>,
    /// The reason if there is nothing to smooth: no triangle is as bad as `--only-bad` requires. The mesh is then
    /// unchanged.
    pub(crate) nothing_to_do: Option<String>,
    /// The topology of the mesh, if the search for layers has found it, and no vertex has been fixed since.
    pub(crate) topology: Option<DetachedTopology>,
}

impl MovableRequest {
    /// Returns whether the request fixes vertices.
    fn restricts(&self) -> bool {
        let Self { fix, fix_vertices, fix_array, fix_box, only, near_bad, .. } = self;
        !fix.is_empty()
            || !fix_vertices.is_empty()
            || !fix_array.is_empty()
            || !fix_box.is_empty()
            || !only.is_empty()
            || near_bad.is_some()
    }

    /// Frees and fixes the vertices of a mesh as requested. `slide` is the request for vertices that slide.
    pub(crate) fn apply(
        &self,
        file: &mut LoadedMesh,
        slide: Option<&SlideRequest>,
    ) -> Result<MovableSelection, CliError> {
        if self.free_interfaces {
            file.domain.free_interfaces();
        }
        if self.free_lines {
            file.domain.free_lines();
        }
        let mut choice = MovableSelection::default();
        choice.notes.extend(self.free_interfaces.then(|| held_interfaces(file)).flatten());
        if self.restricts() {
            self.restrict(file, slide, &mut choice)?;
        }
        if let Some(kept) = self.keep_layers.as_ref().filter(|_| choice.nothing_to_do.is_none()) {
            let layers = keep_layers(file, kept)?;
            choice.notes.extend(layers.notes);
            choice.nothing_to_do = layers.nothing_to_do;
            choice.layers = layers.fixed;
            choice.topology = layers.topology;
        }
        Ok(choice)
    }

    /// Fixes the vertices of a mesh that `--fix…` and `--only…` exclude.
    fn restrict(
        &self,
        file: &mut LoadedMesh,
        slide: Option<&SlideRequest>,
        choice: &mut MovableSelection,
    ) -> Result<(), CliError> {
        let resolver = SelectionResolver::new(file, slide)?;
        choice.free_without = resolver.topology.free_count();
        let fixed = resolver.fixed(self, choice)?;
        let movers = resolver.movers(self, choice)?;
        file.domain.fix(&fixed)?;
        for movers in movers {
            file.domain.fix_all_but(&movers)?;
        }
        Ok(())
    }
}

impl MovableSelection {
    /// Returns whether `--fix…` and `--only…` exclude vertices of a mesh that has free vertices without these options.
    pub(crate) fn excludes_free(&self) -> bool {
        self.free_without > 0
    }
}

/// Returns a note on vertices between regions that remain fixed for another reason; `None` if all were freed.
fn held_interfaces(file: &LoadedMesh) -> Option<String> {
    let held = match file.held_interface_vertices().len() {
        0 => return None,
        1 => "1 vertex between regions is".to_owned(),
        n => format!("{n} vertices between regions are"),
    };
    Some(format!(
        "--free-interfaces: {held} on line elements, points or quadrilaterals of the file, and not freed"
    ))
}

/// Resolver of the names and numbers in options to vertices of a mesh.
struct SelectionResolver<'f> {
    file: &'f LoadedMesh,
    topology: Topology<'f>,
    /// Vertices that would slide without the options, ascending.
    sliding: Vec<u32>,
}

impl<'f> SelectionResolver<'f> {
    fn new(file: &'f LoadedMesh, slide: Option<&SlideRequest>) -> Result<Self, CliError> {
        let topology =
            Topology::new(file.mesh()).map_err(|error| explain::mesh_error(file, &error))?;
        let sliding = match slide {
            Some(slide) => slide.slide(file)?.vertices(&topology, &file.mesh().points)?,
            None => Vec::new(),
        };
        Ok(Self { file, topology, sliding })
    }

    /// Counts the vertices that would be free without the options.
    fn free_among(&self, vertices: &[u32]) -> usize {
        vertices.iter().filter(|&&vertex| self.topology.free()[vertex as usize]).count()
    }

    /// Returns the vertices that options fix, and adds a note for each option.
    fn fixed(
        &self,
        request: &MovableRequest,
        choice: &mut MovableSelection,
    ) -> Result<Vec<u32>, CliError> {
        let file = self.file;
        let mut fixed = Vec::new();
        let mut hold = |option: String, mut vertices: Vec<u32>| {
            vertices.sort_unstable();
            vertices.dedup();
            let (count, free) = (vertices.len(), self.free_among(&vertices));
            let slides = |vertex: &&u32| self.sliding.binary_search(vertex).is_ok();
            let sliding = vertices.iter().filter(slides).count();
            choice.notes.push(format!("{option}: {}", held(count, free, sliding)));
            fixed.append(&mut vertices);
        };
        if !request.fix.is_empty() {
            let groups = file.groups()?;
            for text in &request.fix {
                for (name, group) in named(file, groups, "--fix", text)? {
                    if group.vertices().is_empty() {
                        return Err(refusal(file, "--fix", &format!("{group} has no elements")));
                    }
                    hold(format!("--fix {name} ({group})"), group.vertices().to_vec());
                }
            }
        }
        for list in &request.fix_vertices {
            let vertices = file.source.read_vertices(list)?;
            hold(format!("--fix-vertices {}", list.display()), vertices);
        }
        for name in &request.fix_array {
            let numbers = file.source.point_array(name)?;
            let set = (0..).zip(numbers).filter(|(_, number)| *number != 0.0);
            hold(format!("--fix-array {name}"), set.map(|(vertex, _)| vertex).collect());
        }
        for corners in &request.fix_box {
            let vertices = select::vertices_in_box(file.positions(), *corners);
            let [[x0, y0], [x1, y1]] = corners;
            hold(format!("--fix-box {x0},{y0},{x1},{y1}"), vertices);
        }
        Ok(fixed)
    }

    /// Returns the vertices that `--only` and `--only-bad` let move, one list for each of the two options. A vertex
    /// may move if all lists contain the vertex.
    fn movers(
        &self,
        request: &MovableRequest,
        choice: &mut MovableSelection,
    ) -> Result<Vec<Vec<u32>>, CliError> {
        let file = self.file;
        let mut lists = Vec::new();
        let of_all = self.topology.free_count();
        if !request.only.is_empty() {
            let groups = file.groups()?;
            let (mut triangles, mut quadrilaterals) = (Vec::new(), Vec::new());
            let mut names = Vec::new();
            for text in &request.only {
                for (name, group) in named(file, groups, "--only", text)? {
                    let has_quadrilaterals =
                        file.domain.moves_quadrilaterals() && !group.quadrilaterals().is_empty();
                    if group.triangles().is_empty() && !has_quadrilaterals {
                        return Err(refusal(file, "--only", &format!("{group} has no triangles")));
                    }
                    triangles.extend_from_slice(group.triangles());
                    quadrilaterals.extend_from_slice(group.quadrilaterals());
                    names.push(format!("{name} ({group})"));
                }
            }
            let vertices = self.inside(&triangles, &quadrilaterals);
            let free = self.free_among(&vertices);
            choice.notes.push(format!("--only {}: {}", names.join(", "), may_move(free, of_all)));
            lists.push(vertices);
        }
        if let Some(NearBad { above: limit, rings }) = request.near_bad {
            let points = &self.file.mesh().points;
            let bad = select::corners_above(points, &self.topology, limit);
            if bad.is_empty() {
                let worst = sig6(select::worst(points, &self.topology));
                let kind = self.kind();
                let text = format!("no {kind} has an imr above {limit}; the worst has {worst}");
                choice.nothing_to_do = Some(text);
                return Ok(lists);
            }
            let vertices = select::vertices_near(&self.topology, &bad, rings);
            let free = self.free_among(&vertices);
            let within = match rings {
                0 => "of their vertices".to_owned(),
                rings => format!("within {} of them", counted(rings as usize, "ring")),
            };
            choice.notes.push(format!(
                "--only-bad {limit}: {} above it; {within} {}",
                counted(self.topology.elements(&bad).len(), self.kind()),
                may_move(free, of_all)
            ));
            lists.push(vertices);
        }
        Ok(lists)
    }

    /// Returns the vertices whose elements are all among triangles and quadrilaterals of the file, given by their indices.
    fn inside(&self, triangles: &[u32], quadrilaterals: &[u32]) -> Vec<u32> {
        let mut elements: Vec<Element> =
            triangles.iter().map(|&index| Element::Triangle(index as usize)).collect();
        if self.file.domain.moves_quadrilaterals() {
            // The mesh lacks quadrilaterals of the file that list a vertex twice.
            let chosen: HashSet<usize> = quadrilaterals.iter().map(|&q| q as usize).collect();
            let of_file = self.file.source.proper_quadrilaterals().enumerate();
            let chosen = of_file.filter(|(_, (index, _))| chosen.contains(index));
            elements.extend(chosen.map(|(index, _)| Element::Quadrilateral(index)));
        }
        select::vertices_inside(&self.topology, &elements)
    }

    /// Returns the word for an element of the mesh.
    fn kind(&self) -> &'static str {
        if self.file.mesh().quadrilaterals.is_empty() { "triangle" } else { "element" }
    }
}

/// Describes the effect of an option: `count` fixed vertices, of which `free` would otherwise be free and `sliding` would
/// otherwise slide.
fn held(count: usize, free: usize, sliding: usize) -> String {
    let would = match (free, sliding) {
        (free, 0) => format!("{free} of them would be free"),
        (0, sliding) => format!("{sliding} of them would slide"),
        (free, sliding) => format!("{free} of them would be free, and {sliding} would slide"),
    };
    match (count, free + sliding) {
        (0, _) => "it names no vertex".into(),
        (1, 0) => "1 vertex stays fixed; it was not free before".into(),
        (1, _) if sliding > 0 => "1 vertex stays fixed; it would slide".into(),
        (1, _) => "1 vertex stays fixed; it would be free".into(),
        (_, 0) => format!("{count} vertices stay fixed; none of them was free before"),
        _ => format!("{count} vertices stay fixed; {would}"),
    }
}

fn may_move(free: usize, of_all: usize) -> String {
    format!("{free} of {of_all} free vertices may move")
}
