//! The worst elements or edges of a mesh, in the terms of its file.

use gpu_smooth::Element;
use gpu_smooth::measure::{Better, InnerEdge, Measure, Measured};

use crate::args::QualityArgs;
use crate::load::{LoadedMesh, Place, as_in_file};

/// One of the worst elements or edges.
pub(crate) struct WorstPart {
    pub(crate) place: Place,
    /// Numbers or tags in the file of the corners of an element, or of the ends of an edge.
    pub(crate) vertices: Vec<u64>,
    /// Positions of the vertices in coordinates of the file, without continued longitudes. `at` is their mean.
    pub(crate) corners: Vec<[f64; 2]>,
    pub(crate) at: [f64; 2],
    /// Length of the longest edge.
    pub(crate) length: f64,
    /// Values of the measures with a histogram. Edges have values of measures of edges alone.
    pub(crate) values: Vec<(Measure, f64)>,
    /// Whether the element, or one of the two triangles at the edge, has a free vertex.
    pub(crate) can_move: bool,
}

/// Finds the worst elements by the first measure with a histogram, worst first; the worst edges if the measure is one of
/// edges.
pub(crate) fn worst(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    args: &QualityArgs,
) -> Vec<WorstPart> {
    match args.histograms().first() {
        None => Vec::new(),
        Some(&measure) if measure.is_of_edges() => edges(file, measured, measure, args),
        Some(&measure) => elements(file, measured, measure, args),
    }
}

fn elements(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    measure: Measure,
    args: &QualityArgs,
) -> Vec<WorstPart> {
    let mesh = file.mesh();
    let proper: Vec<&[u32; 4]> = file.source.proper_quadrilaterals().map(|(_, own)| own).collect();
    let found: Vec<usize> =
        measured.worst(measure, args.worst).into_iter().map(|found| found.0).collect();
    // The vertices of an element in the mesh, and in the file, which has no copies of vertices.
    let vertices = |element: Element| -> [&[u32]; 2] {
        match element {
            Element::Triangle(t) => [&mesh.triangles[t], &file.source.triangles()[t]],
            Element::Quadrilateral(k) => [&mesh.quadrilaterals[k], proper[k]],
        }
    };
    let elements: Vec<Element> = found.iter().map(|&index| measured.element(index)).collect();
    let places = Place::of_elements(&file.source, &elements);
    let names = file.vertex_places(elements.iter().flat_map(|&e| vertices(e)[0]).copied());
    let one = |((index, element), place): ((usize, Element), Place)| {
        let [in_mesh, in_file] = vertices(element);
        let points: Vec<[f64; 2]> = in_mesh.iter().map(|&v| mesh.points[v as usize]).collect();
        WorstPart {
            place,
            vertices: in_mesh.iter().map(|v| names[v].id).collect(),
            corners: in_file.iter().map(|&v| file.positions()[v as usize]).collect(),
            at: as_in_file(file, mean(&points)),
            length: longest_edge(&points),
            values: args.histograms().iter().map(|&m| (m, measured.value(m, index))).collect(),
            can_move: measured.topology().can_move(element),
        }
    };
    found.into_iter().zip(elements).zip(places).map(one).collect()
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
        let order = a.value(measure).total_cmp(&b.value(measure));
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
            values: of_edges.map(|&m| (m, edge.value(m))).collect(),
            can_move: edge
                .elements
                .map(|index| measured.element(index as usize))
                .into_iter()
                .any(|element| measured.topology().can_move(element)),
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
