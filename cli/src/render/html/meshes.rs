//! `quality --html`: measured meshes as one page in a single file. A single mesh has a viewer. Several meshes have an overview
//! and a picture each.

use std::fmt::Write;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use gpu_smooth::measure::{Measure, Measured};
use mesh_io::atomic;

use crate::color_scale::ColorScale;
use crate::error::CliError;
use crate::load::LoadedMesh;
use crate::profiles::Profile;
use crate::render::html::overview::MeshNumbers;
use crate::render::html::page::{Page, View, ViewerMesh, escape};
use crate::render::html::tables::{measure_name, noun_of};
use crate::render::html::{charts, mesh, overview, tables, worst};
use crate::render::picture::{Extent, FixedFaces, picture_of};
use crate::report::{Histogram, histogram};

/// Longer side of the picture of each of several meshes, in pixels.
const PIXELS: u32 = 1200;

/// A mesh with the choices of its sections in the page.
pub(crate) struct MeshDescription<'a> {
    pub(crate) file: &'a LoadedMesh,
    pub(crate) measured: &'a Measured<'a>,
    /// Measures of the histograms. The first ranks the worst triangles.
    pub(crate) histograms: &'a [Measure],
    /// The scale of colors by one measure.
    pub(crate) colors: ColorScale,
    /// The profile whose measures of edges the page can show.
    pub(crate) profile: Option<&'a Profile>,
    /// Number of listed worst elements.
    pub(crate) worst: usize,
    /// Whether the page has only this mesh.
    pub(crate) is_alone: bool,
    /// Sentences on the mesh, such as its numbers of vertices and triangles.
    pub(crate) sentences: Vec<String>,
}

/// Sentences, drawing, tables and charts of a mesh as HTML. The mesh itself is not stored.
pub(crate) struct MeshPart {
    sentences: Vec<String>,
    view: MeshView,
    /// The title of the list in `worst`.
    worst_title: String,
    worst: String,
    charts: String,
}

/// The drawing of a mesh.
enum MeshView {
    Viewer(ViewerMesh),
    /// A PNG as a data URL, with a caption; `None` if all vertices have equal positions.
    Picture(Option<[String; 2]>),
}

impl MeshPart {
    pub(crate) fn new(description: MeshDescription<'_>) -> Result<Self, CliError> {
        let MeshDescription {
            file, measured, histograms, colors, worst, is_alone, sentences, ..
        } = description;
        let by = histograms.first().copied().unwrap_or(Measure::Shape);
        let spots = worst::spots_of_mesh(file, measured, by, worst);
        let topology = measured.topology();
        let view = match is_alone {
            true => {
                let (states, bounds) = (&[measured], &mesh::BOUNDS);
                let measures = mesh::measures(colors, histograms, description.profile);
                let mesh = mesh::viewer_mesh(file, states, &spots, &measures, colors, bounds)?;
                MeshView::Viewer(mesh)
            }
            false => {
                let faces = FixedFaces::of(file, topology);
                let extent =
                    Extent::of([topology.triangles(), &faces.pieces], &[measured.points()]);
                let is_drawn = !extent.is_point();
                let draw = || picture_of(topology, &faces, measured, colors, extent, PIXELS);
                let url = |png| format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png));
                let drawn = is_drawn.then(draw).transpose()?;
                MeshView::Picture(drawn.map(|png| [url(png), colors.legend()]))
            }
        };
        let chart = |&measure: &Measure| {
            let Histogram { edges, counts, .. } = histogram(measured, measure);
            let series = charts::Series { class: "after", name: None, counts: &counts };
            charts::bars(&measure_name(measure), noun_of(measure), &edges, &[series])
        };
        let charts: String = histograms.iter().map(chart).collect();
        Ok(Self {
            sentences,
            view,
            worst_title: worst::title(&spots),
            worst: worst::list_of_mesh(&spots, by, file.axes(), is_alone),
            charts: format!("<div class=\"charts\">{charts}</div>"),
        })
    }
}

/// A mesh of a page: numbers for the overview, and section.
pub(crate) struct PageEntry<'a> {
    pub(crate) numbers: MeshNumbers<'a>,
    pub(crate) part: &'a MeshPart,
}

/// Writes a page about measured meshes to `path`.
pub(crate) fn write_meshes(path: &Path, meshes: &[PageEntry<'_>]) -> Result<(), CliError> {
    let failed = |error: CliError| error.within("the page was not written");
    atomic::write(path, page(meshes).as_bytes()).map_err(|error| failed(error.into()))
}

fn page(meshes: &[PageEntry<'_>]) -> String {
    let numbers: Vec<&MeshNumbers<'_>> = meshes.iter().map(|entry| &entry.numbers).collect();
    let measures = tables::measures(numbers.first().map_or(&[], |n| n.statistics));
    let has_quadrilaterals = numbers.iter().any(|mesh| mesh.has_quadrilaterals);
    let notes = tables::notes(&measures, has_quadrilaterals);
    let statistics = |entry: &PageEntry<'_>| {
        tables::statistics_table(&[("", entry.numbers.statistics)], has_quadrilaterals)
    };
    let [entry @ PageEntry { numbers: MeshNumbers { name, .. }, part }] = meshes else {
        let mut page = Page::new(&format!("Quality of {} meshes", meshes.len()));
        page.section("Overview", &(overview::table(&numbers) + &notes));
        for (i, entry) in meshes.iter().enumerate() {
            let content = section(entry, &statistics(entry));
            page.linked_section(&overview::anchor(i), &entry.numbers.name, &content);
        }
        return page.finish();
    };
    let mut page = Page::new(name);
    part.sentences.iter().for_each(|sentence| page.lead(sentence));
    if let MeshView::Viewer(mesh) = &part.view {
        page.mesh(mesh, View::Mesh);
    }
    page.section("Distribution", &part.charts);
    page.columns(&[
        &[(&part.worst_title, part.worst.clone())],
        &[("Statistics", statistics(entry) + &notes)],
    ]);
    page.finish()
}

/// Writes the section of one of several meshes. `statistics` is a table.
fn section(entry: &PageEntry<'_>, statistics: &str) -> String {
    let PageEntry { numbers: MeshNumbers { name, .. }, part } = entry;
    let mut text = String::new();
    for sentence in &part.sentences {
        let _ = write!(text, "<p>{}</p>", escape(sentence));
    }
    if let MeshView::Picture(Some([url, legend])) = &part.view {
        let (about, legend) = (escape(&format!("{name}, colored by quality")), escape(legend));
        let _ = write!(
            text,
            "<figure class=\"picture\"><img src=\"{url}\" alt=\"{about}\"><figcaption>{legend}</figcaption></figure>"
        );
    }
    format!(
        "<div class=\"columns drawn\"><div>{text}</div><div>{statistics}{}</div></div>{}<p><a href=\"#{}\">Overview</a></p>",
        part.worst,
        part.charts,
        overview::TOP
    )
}
