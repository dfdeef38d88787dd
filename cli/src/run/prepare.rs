//! Preparation of a mesh: engine, colors and levels, untangling, targets and sliding.

use std::borrow::Cow;
use std::time::Instant;

use gpu_smooth::layers::Layers;
use gpu_smooth::targets::Surface;
use gpu_smooth::{Backend, DetachedTopology, MeshError, MeshSize, Quality, Smoother};
use gpu_smooth_job::{Adapted, TargetFacts};

use crate::error::CliError;
use crate::load::{InterpolatedFields, LoadedMesh, MovableSelection, SlidingVertices};
use crate::load::{explain, nothing_free, remarks};
use crate::report::Failure;
use crate::request::SmoothRequest;
use crate::run::engine::{self, OpenEngine};
use crate::run::input::Input;
use crate::run::observer::PipelineObserver;
use crate::run::untangle::{self, UntangledInput};
use crate::terminal::progress::Stage;

/// A mesh ready for sweeps, either as read or after untangling.
pub(super) enum Prepared<'a> {
    Ready(Box<Smoother<'a>>),
    UntangledInput(UntangledInput),
}

/// The prepared mesh and the open engine, or the errors that prevented them.
pub(super) struct Opened<'a> {
    pub(super) prepared: Result<Prepared<'a>, Failure>,
    pub(super) taken: Result<OpenEngine, CliError>,
}

/// The smoother of a mesh. `mended` describes the untangling; `None` if the mesh was not untangled.
pub(super) struct Subject<'a> {
    pub(super) smoother: Smoother<'a>,
    pub(super) mended: Option<&'a UntangledInput>,
}

/// Input of the sweeps.
pub(super) struct Ready<'a> {
    pub(super) smoother: Smoother<'a>,
    pub(super) mended: Option<&'a UntangledInput>,
    pub(super) taken: OpenEngine,
    /// Quality of the mesh before the run, and before untangling.
    pub(super) before: Quality,
    /// The weight of sizes; see [`TargetFacts`].
    pub(super) size_weight: Option<f64>,
    /// The sliding vertices; `None` without `--slide`.
    pub(super) sliding: Option<SlidingVertices>,
    /// Time at the end of the preparation.
    pub(super) at: Instant,
}

impl<'a> Subject<'a> {
    /// Prepares an untangled mesh.
    pub(super) fn of_mended(
        file: &LoadedMesh,
        mended: &'a UntangledInput,
    ) -> Result<Self, CliError> {
        let smoother = Smoother::keeping(Cow::Borrowed(&mended.mesh), Layers::default());
        let smoother = smoother.map_err(|error| explain::mesh_error(file, &error))?;
        Ok(Self { smoother, mended: Some(mended) })
    }
}

/// Prepares a mesh while a second thread opens its engine. Untangles the mesh if requested and necessary.
pub(super) fn open<'a>(
    input: &Input<'a>,
    topology: Option<DetachedTopology>,
    fields: &InterpolatedFields,
    engine: impl FnOnce(MeshSize) -> Result<OpenEngine, CliError> + Send,
    follow: &mut dyn PipelineObserver,
) -> Opened<'a> {
    let mesh = input.file.mesh();
    let size = mesh.size();
    follow.stage(Stage::Preparing { vertices: size.vertices });
    std::thread::scope(|scope| {
        let opening = scope.spawn(move || engine(size));
        let prepared = prepared(input, topology, fields, follow);
        let taken = opening.join().map_err(|_| engine::driver_crashed());
        Opened { prepared, taken: taken.and_then(|taken| taken) }
    })
}

fn prepared<'a>(
    input: &Input<'a>,
    topology: Option<DetachedTopology>,
    fields: &InterpolatedFields,
    follow: &mut dyn PipelineObserver,
) -> Result<Prepared<'a>, Failure> {
    let (request, file) = (input.request(), input.file);
    match smoother(request, file, topology) {
        prepared if request.untangle.is_some() && untangle::can_mend(&prepared) => {
            drop(prepared);
            follow.stage(Stage::Untangling);
            fields.check_untangled()?;
            Ok(Prepared::UntangledInput(untangle::untangle_input(input)?))
        }
        Err(error) => Err(refusal(request, input.choice, file, &error)),
        Ok(smoother) => Ok(Prepared::Ready(Box::new(smoother))),
    }
}

/// Sets targets and sliding vertices of a prepared mesh, and measures its quality. If vertices slide on the CPU
/// alone, the CPU replaces `taken`.
pub(super) fn set_up<'a>(
    input: &Input<'a>,
    subject: Subject<'a>,
    taken: OpenEngine,
    follow: &mut dyn PipelineObserver,
) -> Result<Ready<'a>, CliError> {
    let Subject { mut smoother, mended } = subject;
    let (request, file, mesh) = (input.request(), input.file, input.file.mesh());
    let surface = request.surface;
    let points = mended.map_or(&mesh.points, |mended| &mended.mesh.points);
    if surface == Surface::Sphere {
        smoother.project_from_sphere().map_err(|error| explain::mesh_error(file, &error))?;
    }
    if let Some(plane) = file.plane() {
        smoother.set_plane(plane).map_err(|error| explain::mesh_error(file, &error))?;
    }
    if let Some(remark) = mended.and_then(|mended| mended.remark.as_ref()) {
        follow.remark(remark);
    }
    let hanging = smoother.topology().hanging_nodes(&mesh.points)?;
    if let Some(remark) = explain::hanging(file, &hanging) {
        follow.remark(&remark);
    }
    let base = request.scheme().base();
    let (TargetFacts { size_weight, .. }, remark) =
        request.target.set(file, &mut smoother, surface, base)?;
    if let Some(remark) = remark {
        follow.remark(&remark);
    }
    if mended.is_none() && request.max_sweeps() > 0 {
        let (topology, kind) = (smoother.topology(), request.target.kind);
        let adapted = Adapted::before_run(topology, points, surface, kind, base)?;
        if let Some(adapted) = adapted {
            follow.remark(&remarks::adapted(adapted));
        }
    }
    let mut sliding = None;
    if let Some(slide) = &request.slide {
        let vertices = slide.set(file, &mut smoother)?;
        follow.remark(&vertices.remark);
        sliding = Some(vertices);
    }
    let taken = match smoother.stays_on_cpu() {
        true => {
            let reason =
                "vertices slide on the CPU if the mesh is on a sphere or has no free vertex";
            OpenEngine::new(Backend::Cpu, Some(reason.into()))
        }
        false => taken,
    };
    let before = Quality::on(surface, &mesh.points, smoother.topology())?;
    Ok(Ready { smoother, mended, taken, before, size_weight, sliding, at: Instant::now() })
}

/// Prepares a mesh for smoothing, whose topology may be known already. Returns [`MeshError::NothingFree`] if no vertex is free and none can slide.
pub(super) fn smoother<'f>(
    request: &SmoothRequest,
    file: &'f LoadedMesh,
    topology: Option<DetachedTopology>,
) -> Result<Smoother<'f>, MeshError> {
    let mesh = file.mesh();
    // The file has fixed the vertices of its layers.
    let layers = Layers::default();
    let mut smoother = match topology.and_then(|topology| topology.attach(mesh)) {
        Some(topology) => Smoother::of_topology(mesh, topology, layers)?,
        None => Smoother::keeping(Cow::Borrowed(mesh), layers)?,
    };
    if smoother.topology().free_count() == 0 {
        let slide = request.slide.as_ref().and_then(|slide| slide.slide(file).ok());
        let slides = slide.and_then(|slide| smoother.set_slide(Some(&slide)).ok());
        if slides.unwrap_or(0) == 0 {
            return Err(MeshError::NothingFree { vertices: file.mesh().points.len() });
        }
    }
    Ok(smoother)
}

/// Returns the failure of a mesh that cannot be smoothed, with all inverted and flat triangles if a report is
/// requested.
pub(super) fn refusal(
    request: &SmoothRequest,
    choice: &MovableSelection,
    file: &LoadedMesh,
    error: &MeshError,
) -> Failure {
    let refused = match error {
        MeshError::NothingFree { .. } => {
            nothing_free(file, request.slide.is_some(), choice.excludes_free())
        }
        _ => explain::mesh_error(file, error),
    };
    let triangles = match error {
        MeshError::Infeasible { triangles, .. } if !triangles.is_empty() => triangles,
        _ => return refused.into(),
    };
    Failure::of_triangles(request, file, refused, triangles)
}
