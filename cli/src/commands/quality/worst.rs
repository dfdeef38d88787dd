//! The worst triangles or edges of a mesh, in the terms of its file.

use gpu_smooth::Element;
use gpu_smooth::measure::{Better, InnerEdge, Measure, Measured};

use crate::args::QualityArgs;
use crate::load::{LoadedMesh, as_in_file};
use crate::report::{Place, of_edge};

/// One of the worst triangles or edges.
pub(crate) struct WorstPart {
    pub(crate) place: Place,
    /// Numbers or tags in the file of the corners of a triangle, or of the ends of an edge.
    pub(crate) vertices: Vec<u64>,
    /// Positions of the vertices in coordinates of the file, without continued longitudes. `at` is their mean.
    pub(crate) corners: Vec<[f64; 2]>,
    pub(crate) at: [f64; 2],
    /// Length of the longest edge.
    pub(crate) length: f64,
    /// Values of the measures with a histogram; for an edge, of those that are of edges.
    pub(crate) values: Vec<(Measure, f64)>,
    /// Whether the triangle, or one of the two triangles at the edge, has a free vertex.
    pub(crate) can_move: bool,
}

/// Finds the worst triangles by the first measure with a histogram, worst first; the worst edges if the measure is one of
/// edges.
pub(crate) fn worst(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    args: &QualityArgs,
) -> Vec<WorstPart> {
    match args.histograms().first() {
        None => Vec::new(),
        Some(&measure) if measure.is_of_edges() => edges(file, measured, measure, args),
        Some(&measure) => triangles(file, measured, measure, args),
    }
}

fn triangles(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    measure: Measure,
    args: &QualityArgs,
) -> Vec<WorstPart> {
    let mesh = file.mesh();
    let found = measured.worst(measure, args.worst);
    let places = file.source.triangle_locations(found.iter().map(|found| found.0));
    let names = file.vertex_places(found.iter().flat_map(|found| mesh.triangles[found.0]));
    let one = |&(t, _): &(usize, f64)| {
        let points = mesh.triangles[t].map(|v| mesh.points[v as usize]);
        WorstPart {
            place: Place::Triangle(places[&t].clone()),
            vertices: mesh.triangles[t].map(|v| names[&v].id).to_vec(),
            corners: file.source.triangles()[t].map(|v| file.positions()[v as usize]).to_vec(),
            at: as_in_file(file, mean(&points)),
            length: longest_edge(&points),
            values: args.histograms().iter().map(|&m| (m, measured.value(m, t))).collect(),
            can_move: measured.topology().can_move(Element::Triangle(t)),
        }
    };
    found.iter().map(one).collect()
}

fn edges(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    measure: Measure,
    args: &QualityArgs,
) -> Vec<WorstPart> {
    let mut edges = measured.edges();
    // The sort is stable, so equal values keep the order of the mesh.
    edges.sort_by(|a, b| {
        let order = of_edge(measure, a).total_cmp(&of_edge(measure, b));
        if measure.definition().better == Better::Higher { order } else { order.reverse() }
    });
    edges.truncate(args.worst);
    let one = |edge: &InnerEdge| {
        let mut ends =
            edge.vertices.map(|v| (file.vertex_place(v), file.mesh().points[v as usize]));
        ends.sort_by_key(|end| end.0.id);
        let points = ends.each_ref().map(|end| end.1);
        let places = ends.map(|end| end.0);
        let of_edges = args.histograms().iter().filter(|measure| measure.is_of_edges());
        WorstPart {
            vertices: places.iter().map(|place| place.id).collect(),
            place: Place::Edge(places),
            corners: points.map(|point| as_in_file(file, point)).to_vec(),
            at: as_in_file(file, mean(&points)),
            length: longest_edge(&points),
            values: of_edges.map(|&m| (m, of_edge(m, edge))).collect(),
            can_move: edge
                .triangles
                .iter()
                .any(|&t| measured.topology().can_move(Element::Triangle(t as usize))),
        }
    };
    edges.iter().map(one).collect()
}

/// Returns the length of the longest edge between consecutive points, and between the last and the first.
fn longest_edge(points: &[[f64; 2]]) -> f64 {
    let next = points.iter().cycle().skip(1);
    let lengths = points.iter().zip(next).map(|(p, q)| (q[0] - p[0]).hypot(q[1] - p[1]));
    lengths.fold(0.0, f64::max)
}

fn mean(points: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| points.iter().map(|point| point[axis] / points.len() as f64).sum())
}
