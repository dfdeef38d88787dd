//! The picture of `--picture`: a mesh colored by quality, before and after a run.

use std::cmp::Ordering;

use crate::color_scale::ColorScale;
use crate::error::CliError;
use crate::load::{LoadedMesh, axes_legend};
use crate::render::picture::{png, svg};
use crate::request::{PictureFormat, PictureRequest};

use crate::render::picture::canvas::Canvas;
use crate::render::picture::faces::FixedFaces;
use crate::render::picture::font::Font;
use crate::render::picture::layout::{Extent, Frame};
use crate::render::picture::outlines::Outlines;
use crate::render::picture::raster::Raster;
use crate::render::picture::scene::{ColoredEdge, Panel, Scene, Spot, middle};
use gpu_smooth::measure::{InnerEdge, Measure, Measured};
use gpu_smooth::{Element, MeshError, Topology, targets::Surface};
use mesh_io::atomic;

use crate::terminal::numbers::{counted, fit8};

/// Number of the worst triangles or edges from which the marked ones, with disjoint marks, are selected.
const CANDIDATES: usize = 1000;

/// The mesh drawn in a picture.
#[derive(Clone, Copy)]
pub(crate) struct PictureSubject<'a> {
    pub(crate) file: &'a LoadedMesh,
    pub(crate) topology: &'a Topology<'a>,
    /// The surface on which coordinates lie.
    pub(crate) surface: Surface,
}

/// The vertex positions of a mesh before or after a run.
pub(crate) struct MeshState<'a> {
    pub(crate) title: String,
    pub(crate) points: &'a [[f64; 2]],
}

/// Draws and writes the requested picture, with one panel for each state and a common color scale. Does nothing
/// without a request.
pub(crate) fn write(
    request: Option<&PictureRequest>,
    mesh: PictureSubject<'_>,
    states: &[MeshState<'_>],
) -> Result<(), CliError> {
    let Some(request) = request else { return Ok(()) };
    let failed = |error: CliError| error.within("the picture was not written");
    let part = request.part.map(Extent::between);
    let panels = states.iter().map(|state| panel(request.colors, part, mesh, state));
    let panels = panels.collect::<Result<Vec<_>, _>>().map_err(|error| failed(error.into()))?;
    let (before, after) = match states {
        [first, .., last] => (first.points, last.points),
        _ => (&[][..], &[][..]),
    };
    let faces = FixedFaces::of(mesh.file, mesh.topology);
    let scene = Scene {
        colors: request.colors,
        part,
        triangles: mesh.topology.triangles(),
        with_arrows: request.with_arrows,
        outlines: Outlines::of(
            mesh.topology,
            &faces,
            &mesh.file.mesh().fixed,
            mesh.file.interface_edges(),
            [before, after],
        ),
        faces,
        panels,
    };
    let font = Font::new().map_err(failed)?;
    let layout = scene.layout(request.width, &font);
    let [width, height] = layout.size;
    let canvas = match request.format {
        PictureFormat::Png => {
            png::Png::new(width, height).map(|png| Box::new(png) as Box<dyn Canvas>)
        }
        PictureFormat::Svg => {
            svg::Svg::new(width, height).map(|svg| Box::new(svg) as Box<dyn Canvas>)
        }
    };
    let mut canvas = canvas.map_err(failed)?;
    scene.draw(&layout, canvas.as_mut());
    let bytes = canvas.finish().map_err(failed)?;
    atomic::write(&request.path, &bytes).map_err(|error| failed(error.into()))
}

/// Draws only triangles, colored by quality, and fixed faces, as a PNG with transparent background. The picture covers
/// the extent, and its longer side has `longest` pixels.
pub(crate) fn picture_of(
    topology: &Topology<'_>,
    faces: &FixedFaces,
    state: &Measured<'_>,
    colors: ColorScale,
    extent: Extent,
    longest: u32,
) -> Result<Vec<u8>, CliError> {
    let goodness = goodness_of(topology, state, colors)?;
    let [width, height] = extent.size();
    let scale = f64::from(longest) / width.max(height);
    let corner = [width, height].map(|size| (size * scale).ceil());
    let frame = Frame::new(extent, [[0.0; 2], corner]);
    let mut raster = Raster::new([[0.0; 2], corner.map(|x| x as f32)]);
    let triangles = topology.triangles();
    let of_piece = |piece: usize| faces.goodness(piece, triangles.len(), &goodness);
    let pieces = faces.pieces.iter().enumerate().map(|(k, piece)| (piece, of_piece(k)));
    let of_triangles = triangles.iter().zip(goodness.iter().copied());
    for (triangle, goodness) in of_triangles.chain(pieces) {
        raster.fill(triangle.map(|v| frame.place(state.points()[v as usize])), goodness);
    }
    png::encode(&raster)
}

/// Rates each triangle from 0 (bad) to 1 (good) by a scale of colors; inverted and flat triangles get -1.
fn goodness_of(
    topology: &Topology<'_>,
    state: &Measured<'_>,
    colors: ColorScale,
) -> Result<Vec<f32>, MeshError> {
    let values = state.values(colors.measure()).into_iter();
    let mut goodness: Vec<f32> = values.map(|value| colors.goodness(value)).collect();
    for bad in topology.bad_triangles(state.points())? {
        goodness[bad.triangle] = -1.0;
    }
    for bad in topology.bad_quadrilaterals(state.points())? {
        goodness[topology.place(Element::Quadrilateral(bad.quadrilateral))] = -1.0;
    }
    Ok(goodness)
}

fn panel<'a>(
    colors: ColorScale,
    part: Option<Extent>,
    mesh: PictureSubject<'_>,
    state: &MeshState<'a>,
) -> Result<Panel<'a>, MeshError> {
    let measured = Measured::on(mesh.surface, state.points, mesh.topology)?;
    let goodness = goodness_of(mesh.topology, &measured, colors)?;
    let measure = colors.measure();
    let edges = if measure.is_of_edges() { measured.edges() } else { Vec::new() };
    let values = match measure.is_of_edges() {
        true => edges.iter().map(|edge| edge.value(measure)).collect(),
        false => measured.values(measure),
    };
    let triangles = mesh.topology.triangles();
    let quadrilaterals: Vec<[u32; 4]> = mesh.topology.quadrilaterals().collect();
    let corners = |i: usize| match (edges.get(i), triangles.get(i)) {
        (Some(edge), _) => &edge.vertices[..],
        (None, Some(triangle)) => triangle,
        (None, None) => &quadrilaterals[i - triangles.len()],
    };
    let spot = |i: usize| Spot { corners: corners(i).to_vec(), value: values[i] };
    // The drawn part has the triangles or edges with their middle in the part, as rings are at the middle.
    let is_drawn = |&i: &usize| part.is_none_or(|part| part.has(middle(corners(i), state.points)));
    let is_measured = |&i: &usize| !values[i].is_nan();
    let mut drawn: Vec<usize> = (0..values.len()).filter(is_measured).filter(is_drawn).collect();
    let is_worse = |&a: &usize, &b: &usize| measure.is_worse(values[a], values[b]);
    let noun = match (measure.is_of_edges(), quadrilaterals.is_empty()) {
        (true, _) => "edge",
        (false, true) => "triangle",
        (false, false) => "element",
    };
    let numbers = numbers(measure, noun, drawn.iter().map(|&i| values[i]), values.len());
    let order = |a: &usize, b: &usize| match (is_worse(a, b), is_worse(b, a)) {
        (true, _) => Ordering::Less,
        (_, true) => Ordering::Greater,
        _ => a.cmp(b),
    };
    if drawn.len() > CANDIDATES {
        drawn.select_nth_unstable_by(CANDIDATES, order);
        drawn.truncate(CANDIDATES);
    }
    drawn.sort_unstable_by(order);
    let worst = drawn.into_iter().map(spot).collect();
    let colored = |(edge, &value): (&InnerEdge, &f64)| ColoredEdge {
        ends: edge.vertices,
        elements: edge.elements,
        goodness: colors.goodness(value),
    };
    let edges = edges.iter().zip(&values).map(colored).collect();
    let axes = mesh.file.plane().and_then(axes_legend);
    let title = match axes {
        Some(axes) => format!("{}; {axes}", state.title),
        None => state.title.clone(),
    };
    Ok(Panel { title: [title, numbers], points: state.points, goodness, edges, worst })
}

/// Describes the values of a measure of the drawn triangles or edges, whose name is `noun`. `all` is their number in the
/// mesh.
fn numbers(
    measure: Measure,
    noun: &str,
    drawn: impl ExactSizeIterator<Item = f64> + Clone,
    all: usize,
) -> String {
    let count = match drawn.len() {
        0 => return format!("no {noun} has its middle in this part"),
        n if n == all => counted(n, noun),
        n => format!("{n} of {all} {noun}s"),
    };
    let unit = measure.definition().unit;
    let least = drawn.clone().fold(f64::INFINITY, f64::min);
    let most = drawn.clone().fold(f64::NEG_INFINITY, f64::max);
    let mean = drawn.clone().sum::<f64>() / drawn.len() as f64;
    let [least, mean, most] = [least, mean, most].map(fit8);
    format!("{count}; {measure} {least}{unit} to {most}{unit}, mean {mean}{unit}")
}
