//! Error messages about meshes, in the terms of their files.

use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::load::Place;
use crate::load::fixed::nothing_free;
use gpu_smooth::{
    Element, MeshError, Topology,
    topology::{BadQuadrilateral, BadTriangle, Crossing, HangingNode},
};
use mesh_io::{Location, SourceLocation};
use serde::Serialize;
use std::collections::HashSet;
use std::fmt;

/// Largest number of bad triangles, or pairs of crossing edges, listed on the terminal.
pub(crate) const TOLD: usize = 10;

/// The command that lists all bad triangles of a mesh.
pub(crate) const QUALITY_JSON: &str = "gpu-smooth quality --json";

/// An inverted or flat triangle in the terms of its file.
#[derive(Serialize)]
pub(crate) struct BadTriangleReport {
    /// The triangle's number or tag in the file.
    triangle: u64,
    file: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<usize>,
    /// Offset of the triangle in a binary file, which has no lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    byte: Option<usize>,
    /// Numbers or tags of the vertices in the file, in the file's winding order.
    vertices: [u64; 3],
    /// `inverted` or `flat`.
    problem: &'static str,
    #[serde(skip)]
    place: SourceLocation,
}

impl BadTriangleReport {
    /// Describes the triangle, its vertices and its problem, without the location in the file.
    fn statement(&self) -> String {
        let Self { triangle, vertices: [a, b, c], problem, .. } = self;
        format!("triangle {triangle} (vertices {a}, {b}, {c}) is {problem}")
    }
}

/// Returns a report for each bad triangle. One search of the file finds the locations of all triangles.
pub(crate) fn bad_triangles(file: &LoadedMesh, bad: &[BadTriangle]) -> Vec<BadTriangleReport> {
    // File order of the vertices: the library may have reversed the winding.
    let corners = |bad: &BadTriangle| file.mesh().triangles[bad.triangle];
    let places = file.source.triangle_locations(bad.iter().map(|bad| bad.triangle));
    let names = file.vertex_places(bad.iter().flat_map(corners));
    let one = |(bad, place): (&BadTriangle, SourceLocation)| BadTriangleReport {
        triangle: place.id,
        file: place.path.display().to_string(),
        line: match place.location {
            Location::Line(line) => Some(line),
            Location::Byte(_) | Location::Unknown => None,
        },
        byte: match place.location {
            Location::Line(_) | Location::Unknown => None,
            Location::Byte(byte) => Some(byte),
        },
        vertices: corners(bad).map(|v| names[&v].id),
        problem: bad.problem(),
        place,
    };
    bad.iter().zip(places.into_values()).map(one).collect()
}

/// A corner of a quadrilateral that is not convex, in the terms of its file.
pub(crate) struct BadCorner {
    pub(crate) place: Place,
    /// Number or tag of the vertex in the file.
    pub(crate) vertex: u64,
    /// `concave` or `flat`.
    pub(crate) problem: &'static str,
}

/// Writes a sentence with the place, the problem and the vertex.
impl fmt::Display for BadCorner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {} at vertex {}", self.place, self.problem, self.vertex)
    }
}

/// Returns bad corners in the terms of the file. One search of the file finds the places of all quadrilaterals.
pub(crate) fn bad_corners(file: &LoadedMesh, bad: &[BadQuadrilateral]) -> Vec<BadCorner> {
    let elements: Vec<Element> =
        bad.iter().map(|bad| Element::Quadrilateral(bad.quadrilateral)).collect();
    let at = |bad: &BadQuadrilateral| bad.vertices[bad.corner];
    let names = file.vertex_places(bad.iter().map(at));
    let one = |(bad, place): (&BadQuadrilateral, Place)| {
        let (vertex, problem) = (names[&at(bad)].id, bad.problem());
        BadCorner { place, vertex, problem }
    };
    bad.iter().zip(Place::of_elements(&file.source, &elements)).map(one).collect()
}

/// Lists the first [`TOLD`] bad triangles, one per line. If `count` is larger, a last line counts the rest and names
/// `all`, the option or command that lists every triangle.
pub(crate) fn list(first: &[BadTriangleReport], count: usize, all: &str) -> Vec<String> {
    let line = |bad: &BadTriangleReport| format!("{}: {}", bad.place, bad.statement());
    told(first.iter().map(line), count, all)
}

/// Lists bad corners as [`list`] does bad triangles.
pub(crate) fn list_corners(first: &[BadCorner], count: usize, all: &str) -> Vec<String> {
    told(first.iter().map(ToString::to_string), count, all)
}

fn told(lines: impl Iterator<Item = String>, count: usize, all: &str) -> Vec<String> {
    let mut lines: Vec<String> = lines.take(TOLD).collect();
    if count > TOLD {
        lines.push(format!("and {} more; {all} lists all", count - TOLD));
    }
    lines
}

/// Returns an error that lists the first crossings of edges which cannot move, one per line; `None` without crossings.
pub(crate) fn crossings(file: &LoadedMesh, topology: &Topology<'_>) -> Option<CliError> {
    let found = topology.crossings(&file.mesh().points, TOLD + 1).ok()?;
    let places = file.vertex_places(found.iter().flat_map(|crossing| crossing.edges).flatten());
    let line = |crossing: &Crossing| {
        let [[a, b], [c, d]] = crossing.edges;
        let place = &places[&a];
        let [a, b, c, d] = [a, b, c, d].map(|v| places[&v].id);
        format!("{place}: the edge between vertices {a} and {b} crosses that between {c} and {d}")
    };
    let mut list: Vec<String> = found.iter().take(TOLD).map(line).collect();
    list.extend((found.len() > TOLD).then(|| "and more".to_owned()));
    let all = "edges between vertices that are not free, such as boundary edges, cross: triangles overlap there wherever free vertices are";
    (!found.is_empty()).then(|| CliError::input(all).with_details(list))
}

/// Returns whether triangles seem inverted because they reach across the meridian at which longitudes wrap.
pub(crate) fn are_across(file: &LoadedMesh, bad: &[BadTriangle]) -> bool {
    let points = &file.mesh().points;
    let is_far = |bad: &BadTriangle| {
        let x = bad.vertices.map(|v| points[v as usize][0]);
        let (least, most) = x.iter().fold((x[0], x[0]), |(a, b), &x| (a.min(x), b.max(x)));
        most - least >= 180.0
    };
    file.chart().is_none()
        && points.iter().all(|&[x, y]| x.abs() <= 360.0 && y.abs() <= 90.0)
        && bad.iter().any(is_far)
}

/// Returns the first element of a closed part of the mesh, such as a closed surface in space. `None` for meshes on a
/// sphere, or if each part has a boundary.
fn closed_part(file: &LoadedMesh) -> Option<Element> {
    Topology::new(file.mesh()).ok().filter(|_| file.chart().is_none())?.closed_part()
}

/// Returns a remark on vertices that hang on edges of other triangles; `None` without hanging nodes.
pub(crate) fn hanging(file: &LoadedMesh, nodes: &[HangingNode]) -> Option<String> {
    let HangingNode { vertex, edge: [a, b] } = *nodes.first()?;
    let names = file.vertex_places([vertex, a, b]);
    let place = &names[&vertex];
    let [v, a, b] = [vertex, a, b].map(|v| names[&v].id);
    let first = format!(
        "vertex {v} ({place}) is inside the edge between vertices {} and {}",
        a.min(b),
        a.max(b)
    );
    let open = "the mesh is open there, and both sides stay as boundary. Cut the triangles at such edges in two";
    Some(match nodes.len() {
        1 => format!("1 hanging node: {first}; {open}"),
        n => format!("{n} hanging nodes, such as: {first}; {open}"),
    })
}

/// Returns the axis and the value of a coordinate that is equal at all vertices; `None` if both coordinates vary. A
/// mesh with a constant coordinate stands upright on the plane of x and y.
fn constant(points: &[[f64; 2]]) -> Option<(char, f64)> {
    let first = points.first()?;
    let is_constant = |k: usize| points.iter().all(|point| point[k] == first[k]);
    ['x', 'y']
        .into_iter()
        .zip(0..2)
        .find(|&(_, k)| is_constant(k))
        .map(|(name, k)| (name, first[k]))
}

/// Returns whether two of `elements` have equal vertices.
fn has_twins(file: &LoadedMesh, elements: &[Element]) -> bool {
    let vertices = |&element: &Element| {
        let mut vertices = match element {
            Element::Triangle(index) => file.mesh().triangles.get(index)?.to_vec(),
            Element::Quadrilateral(index) => file.mesh().quadrilaterals.get(index)?.to_vec(),
        };
        vertices.sort_unstable();
        Some(vertices)
    };
    let mut seen = HashSet::new();
    elements.iter().filter_map(vertices).any(|vertices| !seen.insert(vertices))
}

/// Returns the name of an element in the terms of the file, such as "triangle 7", and its place.
pub(crate) fn named(file: &LoadedMesh, element: Element) -> (String, String) {
    let index = element.index();
    let (kind, found) = match element {
        Element::Triangle(_) => ("triangle", file.source.triangle_locations([index])),
        Element::Quadrilateral(_) => {
            ("quadrilateral", file.source.quadrilateral_locations([index]))
        }
    };
    match found.get(&index) {
        Some(place) => (format!("{kind} {}", place.id), place.to_string()),
        None => (element.to_string(), file.source.path().display().to_string()),
    }
}

/// Returns an error in the terms of a file: path, location, problem and remedy, on one line unless several triangles
/// are listed.
pub(crate) fn mesh_error(file: &LoadedMesh, error: &MeshError) -> CliError {
    let name = |v: u32| file.vertex_place(v).id;
    let path = file.source.path().display();
    match *error {
        MeshError::Infeasible { ref triangles, ref quadrilaterals } => {
            if let Some((axis, value)) = constant(&file.mesh().points) {
                return CliError::input(format!(
                    "{path}: {axis} of all vertices is {value}, so that every triangle is flat in the plane of x and y, in which meshes are smoothed"
                ))
                .with_remedy(
                    "Turn the mesh into the plane of x and y, or add --z coordinate if z is a coordinate",
                );
            }
            let is_across = are_across(file, triangles);
            if !is_across && let Some(element) = closed_part(file) {
                return mesh_error(file, &MeshError::Closed { element });
            }
            if let Some(bad) = quadrilaterals.first() {
                let (name, place) = named(file, Element::Quadrilateral(bad.quadrilateral));
                let vertex = file.vertex_place(bad.vertices[bad.corner]).id;
                return CliError::input(format!(
                    "{place}: {name} is {} at vertex {vertex}, one of {} corners of quadrilaterals that are not convex",
                    bad.problem(),
                    quadrilaterals.len()
                ))
                .with_remedy("Untangle the mesh first: --untangle, or keep all quadrilaterals fixed: --quadrilaterals keep");
            }
            let remedy = if is_across {
                "The triangles reach from the smallest longitude to the largest: --surface sphere continues longitudes across the meridian at which longitudes wrap, such as 180 degrees"
            } else if file.source.data_names().iter().any(|name| name == "z") {
                "Untangle the mesh first: --untangle. But if this is a surface in space that folds over itself in the plane of x and y, it cannot be smoothed"
            } else {
                "Untangle the mesh first: --untangle. Smoothing alone keeps triangles from inverting, and cannot turn one back"
            };
            let count = triangles.len();
            let (text, details) = match &bad_triangles(file, &triangles[..count.min(TOLD)])[..] {
                [] => (format!("{path}: {error}"), Vec::new()),
                [one] if count == 1 => (format!("{}: {}", one.place, one.statement()), Vec::new()),
                first => (
                    format!("{}: {count} triangles are inverted or flat", first[0].file),
                    // Each command that reads a mesh has this error, but few have --report.
                    list(first, count, QUALITY_JSON),
                ),
            };
            CliError::input(text).with_remedy(remedy).with_details(details)
        }
        MeshError::Closed { element } => {
            let (name, place) = named(file, element);
            CliError::input(format!(
                "{place}: {name} belongs to a part of the mesh without boundary: a closed surface in space"
            ))
            .with_remedy("Only meshes of the plane of x and y are smoothed")
        }
        MeshError::EdgeOfThree { edge, ref elements } => {
            let of_kind = |wants: fn(Element) -> bool| {
                elements.iter().filter(move |e| wants(**e)).map(|e| e.index())
            };
            let triangles = of_kind(|element| matches!(element, Element::Triangle(_)));
            let others = of_kind(|element| matches!(element, Element::Quadrilateral(_)));
            let mut places = file.source.triangle_locations(triangles);
            let kinds = if places.len() == elements.len() { "triangles" } else { "elements" };
            let of_others = file.source.quadrilateral_locations(others);
            let first_of_others = file.mesh().triangles.len();
            places.extend(of_others.into_iter().map(|(k, place)| (first_of_others + k, place)));
            let labels: Vec<_> = places.values().map(|place| place.id.to_string()).collect();
            let mut ends = edge.map(name);
            ends.sort_unstable();
            let [a, b] = ends;
            let remedy = match has_twins(file, elements) {
                true => "Some of them have the same vertices: remove these",
                false => "In a 2D mesh an edge has one or two: remove the others",
            };
            CliError::input(format!(
                "{}: the edge between vertices {a} and {b} belongs to {} {kinds} ({})",
                places.values().last().map(ToString::to_string).unwrap_or_default(),
                labels.len(),
                labels.join(", ")
            ))
            .with_remedy(remedy)
        }
        MeshError::NotFinite { vertex } => {
            CliError::input(format!("{}: {error}", file.vertex_place(vertex)))
                .with_remedy("Correct it")
        }
        MeshError::NothingFree { .. } => nothing_free(file, false, false),
        MeshError::OverlappingStar { vertex, turns } => CliError::input(format!(
            "{}: the triangles around vertex {} overlap: they wind {turns} times around it",
            file.vertex_place(vertex),
            name(vertex)
        ))
        .with_remedy("Only meshes that lie flat are smoothed: separate the layers there"),
        MeshError::BeyondPrecision { element, metric, ref usable } => {
            let others = match &usable[..] {
                [] => String::new(),
                [one] => format!(". The metric {one} can judge this mesh: --scheme {one}"),
                [first, ..] => format!(
                    ". The metrics {} can judge this mesh: --scheme {first}",
                    usable.join(", ")
                ),
            };
            let (name, place) = named(file, element);
            CliError::input(format!(
                "{place}: {name} is too flat, or too small beside the others, for double precision: \
                 {metric} cannot judge it"
            ))
            .with_remedy(format!(
                "Open it with --untangle if one of its vertices is free, or correct it{others}"
            ))
        }
        MeshError::Latitude { vertex } => {
            let place = file.vertex_place(vertex);
            let problem = "its latitude is not between -90 and 90 degrees";
            CliError::input(format!("{place}: vertex {}: {problem}", place.id)).with_remedy(
                "Correct it, or leave out --surface sphere if the coordinates are lengths",
            )
        }
        MeshError::Target { vertex, problem } => {
            let vertex = vertex as u32;
            let place = file.vertex_place(vertex);
            CliError::input(format!("{place}: vertex {}: {problem}", place.id))
        }
        MeshError::Pole { element } => {
            let (name, place) = named(file, element);
            CliError::input(format!(
                "{place}: {name} has a pole of the sphere inside of it or on an edge, where there is no direction east"
            ))
            .with_remedy("Smooth the mesh in a projection around that pole, or with a vertex at the pole itself")
        }
        MeshError::OutOfRange { size: 0.0 } => {
            CliError::input(format!("{path}: all vertices of the elements are at the origin"))
                .with_remedy("Check the columns of the coordinates, or write the mesh again")
        }
        MeshError::OutOfRange { .. } => CliError::input(format!("{path}: {error}"))
            .with_remedy("Write the mesh in another unit"),
        // Readers refuse meshes with the other errors, or the command never requests the runs that cause them.
        _ => CliError::input(format!("{path}: {error}")),
    }
}
