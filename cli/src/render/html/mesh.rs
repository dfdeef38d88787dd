//! The mesh data for the page's script: the whole mesh, or a picture and the elements around the worst ones.

use crate::color_scale::ColorScale;
use crate::error::CliError;
use crate::load::{LoadedMesh, axes_legend};
use std::collections::HashSet;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use gpu_smooth::{
    Element, Topology,
    measure::{Measure, Measured},
};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::profiles::Profile;
use crate::render::html::edges::ShownEdges;
use crate::render::html::page::ViewerMesh;
use crate::render::html::worst::WorstElement;
use crate::render::picture::{
    BAD, Extent, FixedFaces, NEUTRAL, Outlines, PALE, VIRIDIS, picture_of,
};
use crate::terminal::numbers::counted;

/// The measures by which each page can color the mesh.
const SHOWN: [Measure; 4] =
    [Measure::Shape, Measure::MinAngle, Measure::MaxAngle, Measure::SizeRatio];

/// Returns the measures by which a page can color its mesh: the usual ones, that of `colors`, and the measures of edges
/// among `others` and among the limits of a profile.
pub(crate) fn measures(
    colors: ColorScale,
    others: &[Measure],
    profile: Option<&Profile>,
) -> Vec<Measure> {
    let limited = profile.into_iter().flat_map(|profile| &profile.limits);
    let limited = limited.filter_map(|limit| limit.quantity.measure());
    let of_edges = others.iter().copied().chain(limited).filter(|measure| measure.is_of_edges());
    let mut measures = SHOWN.to_vec();
    for measure in [colors.measure()].into_iter().chain(of_edges) {
        if !measures.contains(&measure) {
            measures.push(measure);
        }
    }
    measures
}

/// Limits on the size of a page.
pub(crate) struct Bounds {
    /// Largest number of elements that the page contains completely. Larger meshes are shown by pictures and parts.
    most: usize,
    /// Longer side of each picture, in pixels.
    pixels: u32,
}

/// The default limits, with which a page has at most some 20 MB.
pub(crate) const BOUNDS: Bounds = Bounds { most: 250_000, pixels: 2000 };

/// Number of elements shown around each of the worst elements of a larger mesh.
const AROUND: usize = 1500;

/// Largest number of boundary edges shown of a larger mesh; also that of edges between regions.
const MOST_EDGES: usize = 200_000;

/// Describes in one or two sentences how the page shows a mesh.
fn caption(triangles: usize, faces: &FixedFaces, is_whole: bool) -> String {
    let of_triangles = counted(triangles, "triangle");
    let elements = match (faces.name(), triangles) {
        (None, _) => of_triangles,
        (Some(name), 0) => counted(faces.count, name),
        (Some(name), _) => format!("{of_triangles} and {}", counted(faces.count, name)),
    };
    let kind = if faces.is_empty() { "triangles" } else { "elements" };
    match is_whole {
        true => format!("All {elements}."),
        false => format!(
            "{elements}, too many for a page: the whole is a picture, where the worst of the {kind} that share a pixel \
             shows. The {AROUND} {kind} around each of the worst ones listed below can be enlarged, and have values."
        ),
    }
}

/// Returns what the page shows of a mesh before and after a run, or of one mesh. `states` must not be empty. `colors` is the
/// scale by one of `measures`, which the page shows first; other measures have default scales.
pub(crate) fn viewer_mesh(
    file: &LoadedMesh,
    states: &[&Measured<'_>],
    spots: &[WorstElement],
    measures: &[Measure],
    colors: ColorScale,
    bounds: &Bounds,
) -> Result<ViewerMesh, CliError> {
    let (first, last) = (states[0], states[states.len() - 1]);
    let topology = first.topology();
    let faces = FixedFaces::of(file, topology);
    let is_whole = topology.triangles().len() + faces.pieces.len() <= bounds.most;
    let outlines = Outlines::of(
        topology,
        &faces,
        &file.mesh().fixed,
        file.interface_edges(),
        [first, last].map(|state| state.points()),
    );
    let shown = match is_whole {
        true => (0..topology.element_count()).collect(),
        false => around(file, topology, spots),
    };
    let of_triangles = shown.partition_point(|&index| index < topology.triangles().len());
    let (triangles, quadrilaterals) = shown.split_at(of_triangles);
    let extent =
        Extent::of([topology.triangles(), &faces.pieces], &[first.points(), last.points()]);
    let mut part = Part::new(file.mesh().points.len());
    let corners = triangles.iter().flat_map(|&t| topology.triangles()[t]);
    let triangle_corners: Vec<u32> = corners.map(|v| part.number(v)).collect();
    // A diagonal cuts each quadrilateral into two triangles.
    let first_quadrilateral = topology.triangles().len();
    let mesh_quadrilaterals: Vec<[u32; 4]> = topology.quadrilaterals().collect();
    let corners = quadrilaterals.iter().flat_map(|&index| {
        let [a, b, c, d] = mesh_quadrilaterals[index - first_quadrilateral];
        [a, b, c, a, c, d]
    });
    let halves: Vec<u32> = corners.map(|v| part.number(v)).collect();
    let most_edges = if is_whole { usize::MAX } else { MOST_EDGES };
    let edges = |edges: &[[u32; 2]], part: &mut Part| -> Vec<u32> {
        edges.iter().take(most_edges).flatten().map(|&v| part.number(v)).collect()
    };
    let boundary = edges(&outlines.boundary, &mut part);
    let between = edges(&outlines.between_regions, &mut part);
    let held: Vec<u32> = match is_whole {
        true => outlines.held.iter().map(|&v| part.number(v)).collect(),
        false => Vec::new(),
    };
    let slid: Vec<u32> = match is_whole {
        true => outlines.slid.iter().map(|&v| part.number(v)).collect(),
        false => Vec::new(),
    };
    // Pictures show the faces of larger meshes.
    let (pieces, face_edges) =
        if is_whole { (&faces.pieces[..], &faces.edges[..]) } else { (&[][..], &[][..]) };
    // Quadrilaterals that are elements are shown by their values.
    let others: Vec<usize> = (0..pieces.len()).filter(|&k| !faces.is_of_element(k)).collect();
    let pieces: Vec<u32> = others.iter().flat_map(|&k| pieces[k]).map(|v| part.number(v)).collect();
    let face_edges = face_edges.iter().filter_map(|edge| {
        let piece = others.binary_search(&edge.piece).ok()?;
        let [a, b] = edge.ends.map(|v| part.number(v));
        Some([piece as u32, a, b])
    });
    let face_edges = face_edges.flatten();
    let face_edges: Vec<u32> = face_edges.collect();
    let colored = ShownEdges::of(states, &shown, measures);
    let edges: Vec<u32> = colored.ends().flatten().map(|v| part.number(v)).collect();
    let described = measures.iter().map(|&measure| {
        let scale = colors.or_usual(measure);
        json!({
            "name": measure.name(), "unit": measure.definition().unit,
            "of_edges": measure.is_of_edges(),
            "of_quadrilaterals": measure.of_quadrilateral(),
            // The values at the bad and the good end of the scale.
            "ends": scale.ends(),
            "ticks": scale.ticks().into_iter()
                .map(|(value, name)| json!([scale.goodness(value), name])).collect::<Vec<_>>(),
        })
    });
    let mut both = Vec::new();
    for (k, &state) in states.iter().enumerate() {
        let draw = |&measure: &Measure| {
            let scale = colors.or_usual(measure);
            let png = picture_of(topology, &faces, state, scale, extent, bounds.pixels)?;
            Ok(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png)))
        };
        let pictures = if is_whole { &[][..] } else { measures };
        let of_edges =
            |&measure: &Measure| encoded(colored.values(k, measure).map(f32::to_le_bytes));
        both.push(json!({
            "points": part.points(state.points()),
            "values": values(topology, state, &shown, measures)?,
            "edge_values": measures.iter().map(of_edges).collect::<Vec<_>>(),
            // A picture by each measure; empty if the page contains all elements.
            "pictures": pictures.par_iter().map(draw).collect::<Result<Vec<_>, CliError>>()?,
        }));
    }
    let corners: Vec<Value> = spots
        .iter()
        .map(|spot| {
            let at = shown.binary_search(&topology.place(spot.element)).ok();
            json!({ "element": at, "state": spot.state, "at": spot.at, "size": spot.size })
        })
        .collect();
    let data = json!({
        "colors": VIRIDIS,
        "bad": BAD,
        "neutral": NEUTRAL,
        "pale": PALE,
        "measures": described.collect::<Vec<_>>(),
        // The index of the measure that the page shows first.
        "first": measures.iter().position(|&measure| measure == colors.measure()),
        "extent": [extent.low, extent.high],
        "triangles": indices(&triangle_corners),
        // Two triangles for each quadrilateral a, b, c, d: a, b, c and a, c, d.
        "halves": indices(&halves),
        // Two vertices for each edge between elements, if a measure is one of edges.
        "edges": indices(&edges),
        "boundary": indices(&boundary),
        "between": indices(&between),
        "held": indices(&held),
        "slid": indices(&slid),
        "pieces": indices(&pieces),
        // The index of a piece, and two vertices, for each edge of a face.
        "face_edges": indices(&face_edges),
        "face": faces.name(),
        "states": both,
        "spots": corners,
        "ids": ids(file, triangles, quadrilaterals, first_quadrilateral),
    });
    let mut caption = caption(topology.triangles().len(), &faces, is_whole);
    if let Some(axes) = file.plane().and_then(axes_legend) {
        caption += &format!(" Axes: {axes}.");
    }
    let is_tangled = (states.iter())
        .map(|state| Ok(!bad(topology, state.points())?.is_empty()))
        .collect::<Result<Vec<bool>, CliError>>()?;
    let signs = [
        (true, "boundary", "boundary"),
        (!between.is_empty(), "between", "between regions"),
        (!held.is_empty(), "held", "fixed vertex inside"),
        (!slid.is_empty(), "slid", "vertex that slid"),
        (!pieces.is_empty(), "face", faces.name().unwrap_or_default()),
        (is_tangled.contains(&true), "bad", "inverted or flat"),
        (!spots.is_empty(), "spot", "among the worst"),
    ];
    let signs = signs.into_iter().filter(|sign| sign.0).map(|(_, sign, name)| (sign, name));
    Ok(ViewerMesh { caption, signs: signs.collect(), data })
}

/// Returns the ids that the file gives to the shown triangles, and then to the shown quadrilaterals, whose numbers begin at
/// `first_quadrilateral`, as runs of consecutive ids: for each run, the position of its first element, and the id. Numbers
/// ascend.
fn ids(
    file: &LoadedMesh,
    triangles: &[usize],
    quadrilaterals: &[usize],
    first_quadrilateral: usize,
) -> Vec<[u64; 2]> {
    let locations = file.source.triangle_locations(triangles.iter().copied());
    let of_others = quadrilaterals.iter().map(|index| index - first_quadrilateral);
    let others = file.source.quadrilateral_locations(of_others);
    let all = locations.values().chain(others.values()).map(|place| place.id);
    let mut runs = Vec::new();
    let mut next = None;
    for (at, id) in (0..).zip(all) {
        if next != Some(id) {
            runs.push([at, id]);
        }
        next = id.checked_add(1);
    }
    runs
}

/// Encodes a sequence of little-endian numbers in Base64.
fn encoded<const N: usize>(numbers: impl Iterator<Item = [u8; N]>) -> String {
    BASE64_STANDARD.encode(numbers.flatten().collect::<Vec<u8>>())
}

fn indices(numbers: &[u32]) -> String {
    encoded(numbers.iter().map(|number| number.to_le_bytes()))
}

/// Returns the numbers of the triangles that are inverted or flat, and of the quadrilaterals that are not convex.
fn bad(topology: &Topology<'_>, points: &[[f64; 2]]) -> Result<HashSet<usize>, CliError> {
    let triangles = topology.bad_triangles(points)?.into_iter().map(|bad| bad.triangle);
    let others = topology.bad_quadrilaterals(points)?.into_iter();
    let others = others.map(|bad| topology.place(Element::Quadrilateral(bad.quadrilateral)));
    Ok(triangles.chain(others).collect())
}

/// Returns a Base64 string for each measure with the values of the shown elements in single precision, NaN for triangles that
/// are inverted or flat and quadrilaterals that are not convex.
fn values(
    topology: &Topology<'_>,
    state: &Measured<'_>,
    shown: &[usize],
    measures: &[Measure],
) -> Result<Vec<String>, CliError> {
    let bad = bad(topology, state.points())?;
    let of = |&measure: &Measure| {
        let value = |&t: &usize| match bad.contains(&t) {
            true => f32::NAN,
            false => state.value(measure, t) as f32,
        };
        encoded(shown.iter().map(|t| value(t).to_le_bytes()))
    };
    Ok(measures.iter().map(of).collect())
}

/// Returns the numbers of the elements around each spot, ascending and without repeats. Elements are added in order of their
/// distance from the spot, counted in rings.
fn around(file: &LoadedMesh, topology: &Topology<'_>, spots: &[WorstElement]) -> Vec<usize> {
    let mut all = HashSet::new();
    for spot in spots {
        let (mut met, mut queue) = (HashSet::from([spot.element]), vec![spot.element]);
        let mut next = 0;
        while next < queue.len() && queue.len() < AROUND {
            for &v in file.corners(queue[next]) {
                let star = topology.star(v).iter().map(|&corner| topology.element(corner));
                queue.extend(star.filter(|&element| met.insert(element)));
            }
            next += 1;
        }
        all.extend(queue.into_iter().map(|element| topology.place(element)));
    }
    let mut all: Vec<usize> = all.into_iter().collect();
    all.sort_unstable();
    all
}

/// The shown vertices, renumbered from 0.
struct Part {
    /// The new number of each vertex, `u32::MAX` for vertices without one.
    number: Vec<u32>,
    /// The original number of each shown vertex.
    vertices: Vec<u32>,
}

impl Part {
    fn new(vertices: usize) -> Self {
        Self { number: vec![u32::MAX; vertices], vertices: Vec::new() }
    }

    /// Returns the new number of a vertex. If the vertex has no new number, assigns the next free number.
    fn number(&mut self, vertex: u32) -> u32 {
        let number = &mut self.number[vertex as usize];
        if *number == u32::MAX {
            *number = self.vertices.len() as u32;
            self.vertices.push(vertex);
        }
        *number
    }

    /// Encodes the coordinates of the shown vertices in Base64.
    fn points(&self, points: &[[f64; 2]]) -> String {
        let coordinates = self.vertices.iter().flat_map(|&v| points[v as usize]);
        encoded(coordinates.map(f64::to_le_bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::html::worst;
    use mesh_io::MeshFile;
    use std::path::Path;

    /// Makes a mesh of 80 by 80 squares, each cut into two triangles, with one displaced vertex.
    fn file() -> LoadedMesh {
        let mut text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6561\n".to_owned();
        for i in 0..6561 {
            let (x, y) = (f64::from(i % 81), f64::from(i / 81));
            let x = if i == 3000 { x + 0.9 } else { x };
            text += &format!("{} {x} {y} 0\n", i + 1);
        }
        text += "$EndNodes\n$Elements\n12800\n";
        for i in 0..6400 {
            let a = i / 80 * 81 + i % 80 + 1;
            text += &format!("{} 2 2 1 1 {a} {} {}\n", 2 * i + 1, a + 1, a + 82);
            text += &format!("{} 2 2 1 1 {a} {} {}\n", 2 * i + 2, a + 82, a + 81);
        }
        let bytes = (text + "$EndElements\n").into_bytes();
        LoadedMesh::new(MeshFile::from_bytes(Path::new("m.msh"), bytes).unwrap())
    }

    /// Makes a mesh of 80 by 80 squares, each second of them cut into two triangles, with one displaced vertex.
    fn mixed() -> LoadedMesh {
        let mut text = "# vtk DataFile Version 3.0\nmixed\nASCII\nDATASET UNSTRUCTURED_GRID\n\
                        POINTS 6561 double\n"
            .to_owned();
        for i in 0..6561 {
            let (x, y) = (f64::from(i % 81), f64::from(i / 81));
            text += &format!("{} {y} 0\n", if i == 3000 { x + 0.9 } else { x });
        }
        text += "CELLS 9600 41600\n";
        for i in 0..6400 {
            let a = i / 80 * 81 + i % 80;
            let [b, c, d] = [a + 1, a + 82, a + 81];
            match i % 2 {
                0 => text += &format!("4 {a} {b} {c} {d}\n"),
                _ => text += &format!("3 {a} {b} {c}\n3 {a} {c} {d}\n"),
            }
        }
        let types = (0..6400).map(|i| if i % 2 == 0 { "9\n" } else { "5\n5\n" });
        text += &format!("CELL_TYPES 9600\n{}", types.collect::<String>());
        let file = MeshFile::from_bytes(Path::new("m.vtk"), text.into_bytes());
        LoadedMesh::of_elements(file.unwrap())
    }

    #[test]
    fn quadrilaterals_are_shown_by_their_values_alone_and_around_the_worst() {
        let file = mixed();
        let topology = Topology::new(file.mesh()).unwrap();
        let state = Measured::new(&file.mesh().points, &topology).unwrap();
        let spots = worst::spots(&file, [&state; 2]);
        let is_other = |spot: &WorstElement| matches!(spot.element, Element::Quadrilateral(_));
        assert!(spots.iter().any(is_other) && !spots.iter().all(is_other));
        assert_eq!(worst::title(&spots), "Worst elements");
        let bad = bad(&topology, state.points()).unwrap();
        for most in [20_000, 9_000] {
            let bounds = Bounds { most, pixels: 300 };
            let colors = ColorScale::usual(Measure::Shape);
            let measures = measures(colors, &[], None);
            let data = viewer_mesh(&file, &[&state; 2], &spots, &measures, colors, &bounds);
            let data = data.unwrap().data;
            let decoded = |text: &Value| BASE64_STANDARD.decode(text.as_str().unwrap()).unwrap();
            let count = |key: &str| decoded(&data[key]).len() / 4;
            let (triangles, quadrilaterals) = (count("triangles") / 3, count("halves") / 6);
            match most {
                20_000 => assert_eq!([triangles, quadrilaterals], [6400, 3200]),
                _ => assert!(triangles > 800 && (400..3200).contains(&quadrilaterals)),
            }
            assert_eq!(count("pieces"), 0);
            let values = decoded(&data["states"][0]["values"][0]);
            assert_eq!(values.len() / 4, triangles + quadrilaterals);
            for (spot, told) in spots.iter().zip(data["spots"].as_array().unwrap()) {
                let at = told["element"].as_u64().unwrap() as usize;
                let value = f32::from_le_bytes(values[4 * at..4 * at + 4].try_into().unwrap());
                let index = topology.place(spot.element);
                assert_eq!(at >= triangles, is_other(spot));
                match bad.contains(&index) {
                    true => assert!(value.is_nan()),
                    false => assert_eq!(value, state.value(Measure::Shape, index) as f32),
                }
            }
        }
    }

    #[test]
    fn a_large_mesh_is_a_picture_with_what_is_around_the_worst() {
        let file = file();
        let topology = Topology::new(file.mesh()).unwrap();
        let state = Measured::new(&file.mesh().points, &topology).unwrap();
        let spots = worst::spots(&file, [&state; 2]);
        let of = |most| {
            let bounds = Bounds { most, pixels: 300 };
            let colors = ColorScale::usual(Measure::Shape);
            let measures = measures(colors, &[Measure::FlowLink], None);
            viewer_mesh(&file, &[&state; 2], &spots, &measures, colors, &bounds).unwrap().data
        };
        let count = |data: &Value, key: &str| {
            BASE64_STANDARD.decode(data[key].as_str().unwrap()).unwrap().len() / 4
        };
        let (whole, parts) = (of(12_800), of(12_799));
        assert_eq!(whole["states"][0]["pictures"], json!([]));
        assert_eq!(count(&whole, "triangles"), 3 * 12_800);
        let shown = count(&parts, "triangles") / 3;
        assert!((AROUND..12_800).contains(&shown), "{shown}");
        assert_eq!(count(&parts, "boundary"), 2 * 320);
        assert_eq!(count(&whole, "edges"), 2 * (3 * 12_800 - 320) / 2);
        assert!((shown..3 * shown).contains(&(count(&parts, "edges") / 2)));
        for state in 0..2 {
            let pictures = parts["states"][state]["pictures"].as_array().unwrap();
            // Each measure by which the page colors the mesh has a picture of its own.
            assert_eq!(pictures.len(), parts["measures"].as_array().unwrap().len());
            for (i, picture) in pictures.iter().enumerate() {
                let png = picture.as_str().unwrap().strip_prefix("data:image/png;base64,").unwrap();
                let png = BASE64_STANDARD.decode(png).unwrap();
                // Bytes of the PNG header with the width and height of the picture.
                assert_eq!(png[16..24], [0, 0, 1, 44, 0, 0, 1, 44]);
                assert!(!pictures[..i].contains(picture), "picture {i}");
            }
        }
        // The worst triangles touch the displaced vertex, and both forms show them.
        for data in [&whole, &parts] {
            let first = &data["spots"][0];
            assert!(first["element"].is_u64(), "{first}");
            let [x, y] = [0, 1].map(|axis| first["at"][axis].as_f64().unwrap());
            assert!((x - 3.0).hypot(y - 37.0) < 2.0, "{x} {y}");
        }
    }
}
