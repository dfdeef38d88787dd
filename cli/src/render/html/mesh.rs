//! The mesh data for the page's script: the whole mesh, or a picture and the triangles around the worst ones.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::collections::HashSet;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use gpu_smooth::{
    Topology,
    measure::{Measure, Measured},
};
use serde_json::{Value, json};

use crate::render::html::worst::WorstTriangle;
use crate::render::picture::{Extent, Outlines, VIRIDIS, bad_end, goodness, picture_of, ticks};

/// The measures by which the page can color the mesh. The picture of a large mesh uses the first one.
const SHOWN: [Measure; 4] =
    [Measure::Shape, Measure::MinAngle, Measure::MaxAngle, Measure::SizeRatio];

/// Limits on the size of a page.
pub(crate) struct Bounds {
    /// Largest number of triangles that the page contains completely. Larger meshes are shown by a picture and parts.
    most: usize,
    /// Longer side of the picture, in pixels.
    pixels: u32,
}

/// The default limits, with which a page has at most some 15 MB.
pub(crate) const BOUNDS: Bounds = Bounds { most: 250_000, pixels: 2000 };

/// Number of triangles shown around each of the worst triangles of a larger mesh.
const AROUND: usize = 1500;

/// Largest number of boundary edges shown of a larger mesh; also that of edges between regions.
const MOST_EDGES: usize = 200_000;

/// Describes in one or two sentences how the page shows a mesh.
pub(crate) fn caption(triangles: usize) -> String {
    match triangles > BOUNDS.most {
        false => format!("All {triangles} triangles."),
        true => format!(
            "{triangles} triangles, too many for a page: the whole is a picture by shape, where the worst of the triangles that \
             share a pixel shows. The {AROUND} triangles around each of the worst ones listed below can be enlarged."
        ),
    }
}

/// Returns the JSON that the page's script reads: of the mesh before and after a run, or of one mesh. `states` must not
/// be empty.
pub(crate) fn data(
    file: &LoadedMesh,
    states: &[&Measured<'_>],
    spots: &[WorstTriangle],
    bounds: &Bounds,
) -> Result<Value, CliError> {
    let (first, last) = (states[0], states[states.len() - 1]);
    let topology = first.topology();
    let is_whole = topology.triangles().len() <= bounds.most;
    let outlines = Outlines::of(
        topology,
        &file.mesh().fixed,
        file.source.regions(),
        [first, last].map(|state| state.points()),
    );
    let shown = match is_whole {
        true => (0..topology.triangles().len()).collect(),
        false => around(topology, spots),
    };
    let extent = Extent::of(topology.triangles(), &[first.points(), last.points()]);
    let mut part = Part::new(file.mesh().points.len());
    let corners = shown.iter().flat_map(|&t| topology.triangles()[t]);
    let triangles: Vec<u32> = corners.map(|v| part.number(v)).collect();
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
    let measures = SHOWN.map(|measure| {
        let definition = measure.definition();
        json!({
            "name": measure.name(), "unit": definition.unit, "ideal": definition.ideal,
            // Null for logarithmic scales, which have no bad end.
            "bad": bad_end(measure),
            "ticks": ticks(measure).into_iter()
                .map(|(value, name)| json!([goodness(measure, value), name])).collect::<Vec<_>>(),
        })
    });
    let mut both = Vec::new();
    for &state in states {
        let picture = match is_whole {
            true => None,
            false => Some(picture(topology, state, extent, bounds.pixels)?),
        };
        both.push(json!({
            "points": part.points(state.points()),
            "codes": codes(topology, state, &shown)?,
            "picture": picture,
        }));
    }
    let corners: Vec<Value> = spots
        .iter()
        .map(|spot| {
            let at = shown.iter().position(|&t| t == spot.triangle);
            json!({ "triangle": at, "state": spot.state, "at": spot.at, "size": spot.size })
        })
        .collect();
    Ok(json!({
        "colors": VIRIDIS,
        "measures": measures,
        "extent": [extent.low, extent.high],
        "triangles": indices(&triangles),
        "boundary": indices(&boundary),
        "between": indices(&between),
        "held": indices(&held),
        "slid": indices(&slid),
        "states": both,
        "spots": corners,
    }))
}

/// Encodes a sequence of little-endian numbers in Base64.
fn encoded<const N: usize>(numbers: impl Iterator<Item = [u8; N]>) -> String {
    BASE64_STANDARD.encode(numbers.flatten().collect::<Vec<u8>>())
}

fn indices(numbers: &[u32]) -> String {
    encoded(numbers.iter().map(|number| number.to_le_bytes()))
}

/// Returns a Base64 string for each measure with the 16-bit codes of the shown triangles: 0 for inverted or flat
/// triangles, otherwise from 1 (bad) to 65534 (ideal).
fn codes(
    topology: &Topology<'_>,
    state: &Measured<'_>,
    shown: &[usize],
) -> Result<Vec<String>, CliError> {
    let bad = topology.bad_triangles(state.points())?;
    let bad: HashSet<usize> = bad.into_iter().map(|bad| bad.triangle).collect();
    let of = |measure| {
        let code = |&t: &usize| -> u16 {
            match bad.contains(&t) {
                true => 0,
                false => 1 + (65533.0 * goodness(measure, state.value(measure, t))).round() as u16,
            }
        };
        encoded(shown.iter().map(|t| code(t).to_le_bytes()))
    };
    Ok(SHOWN.map(of).to_vec())
}

/// Draws the whole mesh colored by the first measure. Returns a PNG as a data URL.
fn picture(
    topology: &Topology<'_>,
    state: &Measured<'_>,
    extent: Extent,
    pixels: u32,
) -> Result<String, CliError> {
    let bytes = picture_of(topology, state, SHOWN[0], extent, pixels)?;
    Ok(format!("data:image/png;base64,{}", BASE64_STANDARD.encode(bytes)))
}

/// Returns the triangles around each spot, ascending and without repeats. Triangles are added in order of their
/// distance from the spot, counted in rings.
fn around(topology: &Topology<'_>, spots: &[WorstTriangle]) -> Vec<usize> {
    let mut all = HashSet::new();
    for spot in spots {
        let (mut met, mut queue) = (HashSet::from([spot.triangle]), vec![spot.triangle]);
        let mut next = 0;
        while next < queue.len() && queue.len() < AROUND {
            for &v in &topology.triangles()[queue[next]] {
                let star = topology.star(v).iter().map(|&t| t as usize);
                queue.extend(star.filter(|&t| met.insert(t)));
            }
            next += 1;
        }
        all.extend(queue);
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

    #[test]
    fn a_large_mesh_is_a_picture_with_what_is_around_the_worst() {
        let file = file();
        let topology = Topology::new(file.mesh()).unwrap();
        let state = Measured::new(&file.mesh().points, &topology).unwrap();
        let spots = worst::spots(&file, [&state; 2]);
        let of = |most| data(&file, &[&state; 2], &spots, &Bounds { most, pixels: 300 }).unwrap();
        let count = |data: &Value, key: &str| {
            BASE64_STANDARD.decode(data[key].as_str().unwrap()).unwrap().len() / 4
        };
        let (whole, parts) = (of(12_800), of(12_799));
        assert!(whole["states"][0]["picture"].is_null());
        assert_eq!(count(&whole, "triangles"), 3 * 12_800);
        let shown = count(&parts, "triangles") / 3;
        assert!((AROUND..12_800).contains(&shown), "{shown}");
        assert_eq!(count(&parts, "boundary"), 2 * 320);
        for state in 0..2 {
            let picture = parts["states"][state]["picture"].as_str().unwrap();
            let png = picture.strip_prefix("data:image/png;base64,").unwrap();
            let png = BASE64_STANDARD.decode(png).unwrap();
            // Bytes of the PNG header with the width and height of the picture.
            assert_eq!(png[16..24], [0, 0, 1, 44, 0, 0, 1, 44]);
        }
        // The worst triangles touch the displaced vertex, and both forms show them.
        for data in [&whole, &parts] {
            let first = &data["spots"][0];
            assert!(first["triangle"].is_u64(), "{first}");
            let [x, y] = [0, 1].map(|axis| first["at"][axis].as_f64().unwrap());
            assert!((x - 3.0).hypot(y - 37.0) < 2.0, "{x} {y}");
        }
    }
}
