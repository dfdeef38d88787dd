//! The picture of `--picture`: a mesh colored by quality, before and after a run.

use crate::color_scale::ColorScale;
use crate::error::CliError;
use crate::load::{LoadedMesh, axes_legend};
use crate::render::picture::{color, png, svg};
use crate::request::{PictureFormat, PictureRequest};

use crate::render::picture::canvas::Canvas;
use crate::render::picture::faces::FixedFaces;
use crate::render::picture::font::Font;
use crate::render::picture::layout::{Extent, Frame};
use crate::render::picture::outlines::Outlines;
use crate::render::picture::raster::Raster;
use crate::render::picture::scene::{Panel, Scene};
use gpu_smooth::measure::{Measure, Measured};
use gpu_smooth::{MeshError, Topology, targets::Surface};
use mesh_io::atomic;

use crate::terminal::numbers::fit8;

/// Number of the worst triangles from which the marked triangles, with disjoint marks, are selected.
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
            mesh.file.source.regions(),
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
    let pieces = faces.pieces.iter().map(|piece| (piece, color::UNJUDGED));
    for (triangle, goodness) in topology.triangles().iter().zip(goodness).chain(pieces) {
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
    // The triangles of the drawn part are those with their middle in it, as rings are at the middle.
    let is_drawn = |t: usize| {
        part.is_none_or(|part| {
            let corners = mesh.topology.triangles()[t].map(|v| state.points[v as usize]);
            part.has([0, 1].map(|axis| corners.iter().map(|corner| corner[axis] / 3.0).sum()))
        })
    };
    let values = measured.values(measure).into_iter().enumerate();
    let drawn: Vec<f64> = values.filter(|(t, _)| is_drawn(*t)).map(|(_, value)| value).collect();
    let worst = match part {
        None => measured.worst(measure, CANDIDATES),
        Some(_) => {
            let all = measured.worst(measure, goodness.len()).into_iter();
            all.filter(|(t, _)| is_drawn(*t)).take(CANDIDATES).collect()
        }
    };
    let numbers = numbers(measure, &drawn, goodness.len());
    let axes = mesh.file.plane().and_then(axes_legend);
    let title = match axes {
        Some(axes) => format!("{}; {axes}", state.title),
        None => state.title.clone(),
    };
    Ok(Panel { title: [title, numbers], points: state.points, goodness, worst })
}

/// Describes the values of a measure of the drawn triangles. `all` is the number of triangles of the mesh.
fn numbers(measure: Measure, drawn: &[f64], all: usize) -> String {
    let count = match drawn.len() {
        0 => return "no triangle has its middle in this part".to_owned(),
        n if n == all => format!("{n} triangles"),
        n => format!("{n} of {all} triangles"),
    };
    let unit = measure.definition().unit;
    let least = drawn.iter().copied().fold(f64::INFINITY, f64::min);
    let most = drawn.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = drawn.iter().sum::<f64>() / drawn.len() as f64;
    let [least, mean, most] = [least, mean, most].map(fit8);
    format!("{count}; {measure} {least}{unit} to {most}{unit}, mean {mean}{unit}")
}
