//! Measurements of a mesh for `gpu-smooth quality`.

use crate::error::CliError;
use crate::load::LoadedMesh;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use gpu_smooth::{
    Quality, Topology,
    measure::{Measure, Measured, Statistics},
    topology::BadTriangle,
};
use mesh_io::{Group, Groups, SourceLocation};

use crate::args::QualityArgs;
use crate::commands::quality::worst::{WorstPart, worst};
use crate::limits::Quantity;
use crate::load::explain::{self, BadTriangleReport};
use crate::load::remarks;
use crate::load::streams::read;
use crate::load::{depths, lay_out};
use crate::profiles::Profile;
use crate::render::html::{MeshDescription, MeshPart};
use crate::render::picture::{self, MeshState, PictureSubject};
use crate::report::{Finding, Histogram, ProfileReport, QualityReport, Quantities, histogram};
use crate::request::{Outputs, ThirdCoordinate};
use crate::terminal::progress::{Display, Stage};

/// Measurements of one mesh. The mesh is not stored, so that many meshes can be shown side by side.
pub(crate) struct MeshQuality {
    pub(crate) path: PathBuf,
    pub(crate) format: String,
    pub(crate) remarks: Vec<String>,
    pub(crate) vertices: usize,
    pub(crate) free: usize,
    pub(crate) triangles: usize,
    /// Quality with the fields of a run's report.
    pub(crate) report: QualityReport,
    /// Location of the triangle with the largest inverse mean ratio.
    pub(crate) worst_place: SourceLocation,
    /// Statistics of the measures of `--measure`, or of all measures.
    pub(crate) statistics: Vec<Statistics>,
    pub(crate) regions: Vec<Region>,
    pub(crate) histograms: Vec<Histogram>,
    /// The worst triangles or edges by the first measure with a histogram, worst first.
    pub(crate) worst: Vec<WorstPart>,
    /// The parts of the mesh with values in the ranges of `--threshold`.
    pub(crate) findings: Vec<Finding>,
    /// The mesh beside the limits of `--for`.
    pub(crate) profile: Option<ProfileReport>,
    /// Inverted and flat triangles: all for JSON, otherwise the first [`explain::TOLD`].
    pub(crate) bad: Vec<BadTriangleReport>,
    pub(crate) flat: usize,
    pub(crate) hanging_nodes: usize,
    pub(crate) duplicate_vertices: usize,
    pub(crate) unused_vertices: usize,
    /// Section of the mesh for the page; `None` without `--html`.
    pub(crate) page: Option<MeshPart>,
}

/// A region of the file: a class of triangles.
pub(crate) struct Region {
    /// Location of the region's first triangle.
    pub(crate) first: SourceLocation,
    /// The groups that contain the region's triangles, named groups first.
    pub(crate) groups: Vec<GroupNames>,
    /// Number of triangles.
    pub(crate) triangles: usize,
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
        let mut file = read(path, &(&args.reading).into())?;
        let settings = args.coordinates.settings();
        let surface = settings.surface;
        let laid_out = lay_out(&mut file, surface, ThirdCoordinate::of(settings, &[]))?;
        let file = file;
        let mesh = file.mesh();
        let refused = |error| explain::mesh_error(&file, &error);
        let topology = Topology::new(mesh).map_err(refused)?;
        let quality = Quality::on(surface, &mesh.points, &topology).map_err(refused)?;
        let bad = topology.bad_triangles(&mesh.points).map_err(refused)?;
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
                sentences: sentences(&file, &topology, bad.len(), &remarks),
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
        let listed = if args.json { bad.len() } else { bad.len().min(explain::TOLD) };
        Ok(Self {
            path: path.to_owned(),
            format: file.source.format().to_string(),
            remarks,
            vertices: file.source.points().len(),
            free: topology.free_count(),
            triangles: mesh.triangles.len(),
            report: QualityReport::from(&quality),
            worst_place: file.source.triangle_location(quality.worst.index()),
            statistics: measured.statistics(&args.statistics()),
            regions: match args.by_region {
                true => regions(&file, &measured, &args.statistics())?,
                false => Vec::new(),
            },
            histograms: args.histograms().iter().map(|&m| histogram(&measured, m)).collect(),
            worst: worst(&file, &measured, args),
            profile: profile.map(|profile| ProfileReport::new(profile, &quantities)),
            findings: args.threshold.iter().map(|t| quantities.finding(t)).collect(),
            bad: explain::bad_triangles(&file, &bad[..listed]),
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
    let (vertices, triangles) = (file.source.points().len(), topology.triangles().len());
    let (format, free) = (file.source.format(), topology.free_count());
    let mut sentences =
        vec![format!("{format}: {vertices} vertices ({free} free), {triangles} triangles")];
    sentences.push(match bad {
        0 => "No triangle is inverted or flat".to_owned(),
        1 => "1 triangle is inverted or flat".to_owned(),
        n => format!("{n} triangles are inverted or flat"),
    });
    sentences.extend_from_slice(remarks);
    sentences
}

/// Counts the vertices of the file that no triangle uses. On the sphere, triangles at a pole or at a cut of the globe
/// use copies of vertices, so the triangles of the file are searched.
fn unused(file: &LoadedMesh, measured: &Measured<'_>) -> usize {
    let unused = measured.unused_vertices();
    if file.chart().is_none() {
        return unused.len();
    }
    let used: HashSet<&u32> = file.source.triangles().as_flattened().iter().collect();
    unused.iter().filter(|v| !used.contains(v)).count()
}

fn regions(
    file: &LoadedMesh,
    measured: &Measured<'_>,
    measures: &[Measure],
) -> Result<Vec<Region>, CliError> {
    let zeros;
    let regions = match file.source.regions() {
        Some(regions) => regions,
        None => {
            zeros = vec![0; measured.count()];
            &zeros
        }
    };
    let count = regions.iter().max().map_or(0, |&most| most as usize + 1);
    let mut first = vec![None; count];
    let mut triangles = vec![0; count];
    for (t, &region) in regions.iter().enumerate() {
        first[region as usize].get_or_insert(t);
        triangles[region as usize] += 1;
    }
    let first: Vec<usize> = first.into_iter().map(Option::unwrap_or_default).collect();
    let places = file.source.triangle_locations(first.iter().copied());
    let statistics = measured.statistics_by_region(measures, regions, count);
    let groups = file.source.groups()?;
    let mut named = groups_of(&first, &groups).into_iter();
    let region = |((first, triangles), statistics): ((&usize, usize), Vec<Statistics>)| Region {
        first: places[first].clone(),
        triangles,
        groups: named.next().unwrap_or_default(),
        statistics,
    };
    Ok(first.iter().zip(triangles).zip(statistics).map(region).collect())
}

/// Returns the groups of each triangle in `triangles`, named groups first. All triangles of a region belong to equal
/// groups, so one triangle represents its region.
fn groups_of(triangles: &[usize], groups: &Groups) -> Vec<Vec<GroupNames>> {
    // One pass over each group's triangles suffices, though the mesh may have as many regions as groups.
    let asked: HashMap<u32, usize> = triangles.iter().map(|&t| t as u32).zip(0..).collect();
    let mut found: Vec<Vec<(&Group, GroupNames)>> = vec![Vec::new(); triangles.len()];
    for (group, spelling) in groups.iter().zip(groups.unique_names()) {
        let regions: Vec<usize> =
            group.triangles().iter().filter_map(|t| asked.get(t)).copied().collect();
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
