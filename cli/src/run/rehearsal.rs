//! Reading and preparation of a mesh without sweeps, for `--dry-run`.

use std::time::Instant;

use gpu_smooth::{Backend, MeshSize, Topology};

use crate::error::CliError;
use crate::load::explain;
use crate::load::{FixedBy, LoadedMesh};
use crate::report::{Failure, SmoothJob};
use crate::run::engine::OpenEngine;
use crate::run::input::Input;
use crate::run::observer::PipelineObserver;
use crate::run::pipeline::{self, ReadMesh};
use crate::run::prepare::{self, Ready, Subject};
use crate::run::run_report;
use crate::run::untangle;
use crate::terminal::progress::Stage;

/// Numbers of free and fixed vertices, and the engine of a run.
pub(crate) struct Rehearsal {
    /// The format of IN, and the format of OUT if the formats differ.
    pub(crate) format: String,
    pub(crate) vertices: usize,
    pub(crate) triangles: usize,
    /// Number of quadrilaterals whose vertices may move.
    pub(crate) quadrilaterals: usize,
    /// Number of vertices that would move.
    pub(crate) free: usize,
    /// Number of vertices that would slide; `None` without `--slide`, or if the mesh would be untangled first.
    pub(crate) sliding: Option<usize>,
    /// Numbers of vertices that are not free, by the reason.
    pub(crate) fixed: Vec<(FixedBy, usize)>,
    /// Numbers of inverted or flat triangles and of concave quadrilaterals, which the run would untangle first.
    pub(crate) bad: [usize; 2],
    /// The reason why the run would do nothing; `None` if the run would smooth the mesh.
    pub(crate) nothing_to_do: Option<String>,
    /// Name of the GPU adapter; `None` for the CPU.
    pub(crate) adapter: Option<String>,
    /// The reason for the choice of the engine; `None` if the command line determined the engine.
    pub(crate) reason: Option<String>,
}

/// Reads, checks and prepares a mesh as a run does, and opens the engine. Neither untangles nor smooths the mesh, and
/// writes no file.
pub(crate) fn rehearse(
    task: &SmoothJob<'_>,
    engine: impl FnOnce(MeshSize) -> Result<OpenEngine, CliError>,
    follow: &mut dyn PipelineObserver,
) -> Result<Rehearsal, Failure> {
    let began = Instant::now();
    let ReadMesh { file, mut choice, fields, form, bytes, .. } = pipeline::read(task, follow)?;
    let topology = choice.topology.take();
    let input = Input { task, file: &file, choice: &choice, form, bytes, began };
    let (request, mesh) = (task.request, file.mesh());
    let size = mesh.size();
    follow.stage(Stage::Preparing { vertices: size.vertices });
    let smoother = prepare::smoother(request, &file, topology);
    if request.untangle.is_some() && untangle::can_mend(&smoother) {
        fields.check_untangled()?;
        let topology = Topology::new(mesh).map_err(|error| explain::mesh_error(&file, &error))?;
        let triangles = topology.bad_triangles(&mesh.points).map_err(CliError::from)?.len();
        let corners = topology.bad_quadrilaterals(&mesh.points).map_err(CliError::from)?;
        let mut concave: Vec<usize> = corners.iter().map(|bad| bad.quadrilateral).collect();
        concave.dedup();
        let bad = [triangles, concave.len()];
        let rehearsal = Rehearsal { bad, ..of_topology(&input, &topology, &engine(size)?) };
        return Ok(rehearsal);
    }
    let smoother = smoother.map_err(|error| prepare::refusal(request, &choice, &file, &error))?;
    let subject = Subject { smoother, mended: None };
    let Ready { smoother, taken, sliding, .. } =
        prepare::set_up(&input, subject, engine(size)?, follow)?;
    let sliding = sliding.map(|sliding| sliding.count);
    Ok(Rehearsal { sliding, ..of_topology(&input, smoother.topology(), &taken) })
}

fn of_topology(input: &Input<'_>, topology: &Topology<'_>, taken: &OpenEngine) -> Rehearsal {
    let file: &LoadedMesh = input.file;
    Rehearsal {
        format: run_report::formats(input),
        vertices: file.source.points().len(),
        triangles: file.mesh().triangles.len(),
        quadrilaterals: file.mesh().quadrilaterals.len(),
        free: topology.free_count(),
        sliding: None,
        fixed: FixedBy::counts(file, topology, &input.choice.layers),
        bad: [0; 2],
        nothing_to_do: input.choice.nothing_to_do.clone(),
        adapter: match &*taken.backend {
            Backend::Cpu => None,
            Backend::Gpu(gpu) => Some(gpu.adapter().name.clone()),
        },
        reason: taken.reason.clone(),
    }
}
