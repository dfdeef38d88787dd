//! Measurements of a mesh for `gpu-smooth quality`.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use gpu_smooth::{
    Element, Quality, Topology,
    measure::{Measure, Measured, Statistics},
    topology::BadTriangle,
};
use mesh_io::{Group, Groups, MeshFile};

use crate::args::QualityArgs;
use crate::commands::quality::worst::{WorstPart, worst};
use crate::limits::Quantity;
use crate::load::explain::{self, BadCorner, BadTriangleReport};
use crate::load::remarks;
use crate::load::streams::read;
use crate::load::{Place, depths, lay_out};
use crate::profiles::Profile;
use crate::render::html::{MeshDescription, MeshPart};
use crate::render::picture::{self, MeshState, PictureSubject};
use crate::report::{Finding, Histogram, ProfileReport, QualityReport, Quantities, histogram};
use crate::request::{Outputs, ReadRequest, ThirdCoordinate};
use crate::terminal::numbers::elements;
use crate::terminal::progress::{Display, Stage};

/// Measurements of one mesh. The mesh is not stored, so that many meshes can be shown side by side.
pub(crate) struct MeshQuality {
    pub(crate) path: PathBuf,
    pub(crate) format: String,
    pub(crate) remarks: Vec<String>,
    pub(crate) vertices: usize,
    pub(crate) free: usize,
    pub(crate) triangles: usize,
    /// Number of measured quadrilaterals.
    pub(crate) quadrilaterals: usize,
    /// Quality with the fields of a run's report.
    pub(crate) report: QualityReport,
    /// The element with the largest inverse mean ratio.
    pub(crate) worst_place: Place,
    /// Statistics of the measures of `--measure`, or of all measures.
    pub(crate) statistics: Vec<Statistics>,
    pub(crate) regions: Vec<Region>,
    pub(crate) histograms: Vec<Histogram>,
    /// The worst elements or edges by the first measure with a histogram, worst first.
    pub(crate) worst: Vec<WorstPart>,
    /// The parts of the mesh with values in the ranges of `--threshold`.
    pub(crate) findings: Vec<Finding>,
    /// The mesh beside the limits of `--for`.
    pub(crate) profile: Option<ProfileReport>,
    /// Numbers of inverted and flat triangles, and of corners of quadrilaterals that are not convex.
    pub(crate) bad_counts: [usize; 2],
    /// Inverted and flat triangles: all for JSON, otherwise the first [`explain::TOLD`].
    pub(crate) bad: Vec<BadTriangleReport>,
    /// Corners of quadrilaterals that are not convex: all for JSON, otherwise the first [`explain::TOLD`].
    pub(crate) bad_corners: Vec<BadCorner>,
    pub(crate) flat: usize,
    pub(crate) hanging_nodes: usize,
    pub(crate) duplicate_vertices: usize,
    pub(crate) unused_vertices: usize,
    /// Section of the mesh for the page; `None` without `--html`.
    pub(crate) page: Option<MeshPart>,
}

/// A region of the file: a class of elements.
pub(crate) struct Region {
    /// The region's first triangle; without triangles, its first quadrilateral.
    pub(crate) first: Place,
    /// The groups that contain the region's triangles, named groups first.
    pub(crate) groups: Vec<GroupNames>,
    pub(crate) triangles: usize,
    pub(crate) quadrilaterals: usize,
    /// Statistics of the region by the measures of `MeshQuality::statistics`.
    pub(crate) statistics: Vec<Statistics>,
}

/// Names of a group of the file.
#[derive(Clone)]
pub(crate) struct GroupNames {
    /// The name in the spelling that options accept, such as `--only`.
    pub(crate) spelling: String,
    /// Kind and dimension, such as `physical surface`.
    pub(crate) kind: String,
    /// Whether the group has triangles of one region only.
    pub(crate) is_of_one_region: bool,
}

impl MeshQuality {
    /// Reads and measures a mesh, and draws the requested picture and section of the page.
    pub(crate) fn of(
        path: &Path,
        args: &QualityArgs,
        profile: Option<&Profile>,
        outputs: &Outputs,
        display: &Display,
    ) -> Result<Self, CliError> {
        display
            .stage(Stage::Reading { bytes: std::fs::metadata(path).map_or(0, |file| file.len()) });
        let reading = ReadRequest::from(&args.reading).moving(args.quadrilaterals);
        let mut file = read(path, &reading.taking_quadrilaterals_alone())?;
        let settings = args.coordinates.settings();
        let surface = settings.surface;
        let laid_out = lay_out(&mut file, surface, ThirdCoordinate::of(settings, &[]))?;
        let file = file;
        let mesh = file.mesh();
        let refused = |error| explain::mesh_error(&file, &error);
        let topology = Topology::new(mesh).map_err(refused)?;
        let quality = Quality::on(surface, &mesh.points, &topology).map_err(refused)?;
        let bad = topology.bad_triangles(&mesh.points).map_err(refused)?;
        let bad_corners = topology.bad_quadrilaterals(&mesh.points).map_err(refused)?;
        let measured = Measured::on(surface, &mesh.points, &topology).map_err(refused)?;
        let hanging = topology.hanging_nodes(&mesh.points).map_err(refused)?;
        let picture = outputs.picture.as_ref();
        if let Some(picture) = picture {
            picture.check_part(&mesh.points)?;
        }
        if picture.is_some() || args.html.is_some() {
            display.stage(Stage::Drawing { triangles: mesh.triangles.len() });
        }
        let title = path.file_name().unwrap_or_default().display().to_string();
        let state = MeshState { title, points: &mesh.points };
        picture::write(
            picture,
            PictureSubject { file: &file, topology: &topology, surface },
            &[state],
        )?;
        let remarks: Vec<String> = remarks::remarks(&file, false)
            .into_iter()
            .chain(laid_out)
            .chain(explain::hanging(&file, &hanging))
            .collect();
        let page = args.html.as_ref().map(|_| {
            MeshPart::new(MeshDescription {
                file: &file,
                measured: &measured,
                histograms: args.histograms(),
                colors: outputs.colors,
                profile,
                worst: args.worst,
                is_alone: args.meshes.len() == 1,
                sentences: sentences(&file, &topology, quality.inverted, &remarks),
            })
        });
        let page = page.transpose()?;
        let limited = args.threshold.iter().map(|threshold| threshold.quantity);
        let limited: Vec<Quantity> =
            limited.chain(profile.into_iter().flat_map(Profile::limited)).collect();
        let needs_depths =
            limited.contains(&Quantity::TimeStep) || profile.is_some_and(Profile::needs_depths);
        let depths = if needs_depths { depths(&file, &[])? } else { None };
        let quantities = Quantities::new(&file, &measured, depths);
        limited.iter().try_for_each(|&quantity| quantities.check(quantity))?;
        args.threshold.iter().try_for_each(|limit| quantities.check_elements(limit.quantity))?;
        let listed = if args.json { usize::MAX } else { explain::TOLD };
        let [of_triangles, of_corners] = [bad.len(), bad_corners.len()].map(|n| n.min(listed));
        Ok(Self {
            path: path.to_owned(),
            format: file.source.format().to_string(),
            remarks,
            vertices: file.source.points().len(),
            free: topology.free_count(),
            triangles: mesh.triangles.len(),
            quadrilaterals: mesh.quadrilaterals.len(),
            report: QualityReport::from(&quality),
            worst_place: Place::of_element(&file.source, quality.worst),
            statistics: measured.statistics(&args.statistics()),
            regions: match args.by_region {
                true => regions(&file, &measured, &args.statistics())?,
                false => Vec::new(),
            },
            histograms: args.histograms().iter().map(|&m| histogram(&measured, m)).collect(),
            worst: worst(&file, &measured, args),
            profile: profile.map(|profile| ProfileReport::new(profile, &quantities)),
            findings: args.threshold.iter().map(|t| quantities.finding(t)).collect(),
            bad_counts: [bad.len(), bad_corners.len()],
            bad: explain::bad_triangles(&file, &bad[..of_triangles]),
            bad_corners: explain::bad_corners(&file, &bad_corners[..of_corners]),
            flat: bad.iter().filter(|bad: &&BadTriangle| bad.flat).count(),
            hanging_nodes: hanging.len(),
            duplicate_vertices: measured.duplicate_vertices().len(),
            unused_vertices: unused(&file, &measured),
            page,
        })
    }
}

/// Returns the sentences on a mesh at the top of a page.
fn sentences(
    file: &LoadedMesh,
    topology: &Topology<'_>,
    bad: usize,
    remarks: &[String],
) -> Vec<String> {
    let vertices = file.source.points().len();
    let elements = elements(topology.triangles().len(), topology.quadrilaterals().len());
    let (format, free) = (file.source.format(), topology.free_count());
    let mut sentences = vec![format!("{format}: {vertices} vertices ({free} free), {elements}")];
    let (one, several, problem) = match topology.quadrilaterals().len() {
        0 => ("triangle", "triangles", "inverted or flat"),
        _ => ("element", "elements", "inverted, flat or not convex"),
    };
    sentences.push(match bad {
        0 => format!("No {one} is {problem}"),
        1 => format!("1 {one} is {problem}"),
        n => format!("{n} {several} are {problem}"),
    });
    sentences.extend_from_slice(remarks);
    sentences
}

/// Counts the vertices of the file that no element uses. On the sphere, elements at a pole or at a cut of the globe
/// use copies of vertices, so the elements of the file are searched.
fn unused(file: &LoadedMesh, measured: &Measured<'_>) -> usize {
    let unused = measured.unused_vertices();
    if file.chart().is_none() {
        return unused.len();
    }
    let of_quadrilaterals = file.source.proper_quadrilaterals().flat_map(|(_, own)| own);
    let used: HashSet<&u32> =
        file.source.triangles().as_flattened().iter().chain(of_quadrilaterals).collect();
    unused.iter().filter(|v| !used.contains(v)).count()
}

fn regions(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    measures: &[Measure],
) -> Result<Vec<Region>, CliError> {
    let triangles = file.mesh().triangles.len();
    let mut regions = match file.source.regions() {
        Some(regions) => regions.to_vec(),
        None => vec![0; triangles],
    };
    let of_file = file.source.quadrilateral_regions();
    let proper = file.source.proper_quadrilaterals();
    let of_quadrilaterals = proper.filter_map(|(index, _)| of_file.get(index).copied());
    // Without regions of the file, all elements are of one region.
    regions
        .extend(of_quadrilaterals.chain(std::iter::repeat(0)).take(measured.count() - triangles));
    let count = regions.iter().max().map_or(0, |&most| most as usize + 1);
    let mut first = vec![None; count];
    let mut counts = vec![[0, 0]; count];
    for (index, &region) in regions.iter().enumerate() {
        first[region as usize].get_or_insert(measured.element(index));
        counts[region as usize][usize::from(index >= triangles)] += 1;
    }
    let statistics = measured.statistics_by_region(measures, &regions, count);
    // A number of the file may belong to elements that are not measured.
    let known = first.into_iter().zip(counts).zip(statistics);
    let known = known.filter_map(|((first, counts), found)| Some((first?, counts, found)));
    let known: Vec<(Element, [usize; 2], Vec<Statistics>)> = known.collect();
    let first: Vec<Element> = known.iter().map(|(first, ..)| *first).collect();
    let groups = file.groups()?;
    let named = groups_of(&first, groups, &file.source).into_iter();
    let places = Place::of_elements(&file.source, &first).into_iter();
    let mut regions = Vec::with_capacity(known.len());
    for ((first, groups), (_, counts, statistics)) in places.zip(named).zip(known) {
        let [triangles, quadrilaterals] = counts;
        regions.push(Region { first, groups, triangles, quadrilaterals, statistics });
    }
    Ok(regions)
}

/// Returns the groups of each element in `elements`, named groups first. All triangles of a region belong to equal
/// groups, and so do all quadrilaterals, so one element represents its region.
fn groups_of(elements: &[Element], groups: &Groups, file: &MeshFile) -> Vec<Vec<GroupNames>> {
    // One pass over each group's elements suffices, though the mesh may have as many regions as groups.
    let proper: Vec<usize> = file.proper_quadrilaterals().map(|(index, _)| index).collect();
    let of_file = |element: &Element| match *element {
        Element::Triangle(index) => Element::Triangle(index),
        Element::Quadrilateral(index) => Element::Quadrilateral(proper[index]),
    };
    let asked: HashMap<Element, usize> = elements.iter().map(of_file).zip(0..).collect();
    let mut found: Vec<Vec<(&Group, GroupNames)>> = vec![Vec::new(); elements.len()];
    for (group, spelling) in groups.iter().zip(groups.unique_names()) {
        let triangles = group.triangles().iter().map(|&t| Element::Triangle(t as usize));
        let others = group.quadrilaterals().iter().map(|&q| Element::Quadrilateral(q as usize));
        let regions: Vec<usize> =
            triangles.chain(others).filter_map(|element| asked.get(&element)).copied().collect();
        for &region in &regions {
            let kind = format!("{} {}", group.kind, group.dimension_name());
            let spelling = spelling.clone();
            let names = GroupNames { spelling, kind, is_of_one_region: regions.len() == 1 };
            found[region].push((group, names));
        }
    }
    let sorted = |mut found: Vec<(&Group, GroupNames)>| {
        found.sort_by_key(|(group, _)| group.name.is_none());
        found.into_iter().map(|(_, names)| names).collect()
    };
    found.into_iter().map(sorted).collect()
}
